// What the parts of a stepper look at together. All of it outlives them.
#pragma once

#include "engine/scene/builder.h"
#include "engine/step/increment_data.h"
#include "engine/step/methods.h"
#include "engine/step/state_layout.h"

namespace isochor {

struct StepContext {
  const WorldOptions& options;
  const std::vector<BodyData>& bodies;
  const Parallel& parallel;
  Methods& methods;
  IncrementData& data;
  State& state;
  StateLayout layout;
  // That the scene begins with; empty where stencils do not change with what is close.
  const std::vector<std::shared_ptr<const StencilPool>>& first_stencils;

  const System& system() const { return methods.system(); }
  std::span<const double> pool_memory() const { return layout.of_pools(state.extra); }
};

// Where an increment is on its way: positions, multipliers, and where inertia alone would carry the nodes.
struct Trial {
  std::vector<Vec3> x, predicted;
  std::vector<double> lambda;

  void begin_at(std::span<const Vec3> positions, std::span<const double> multipliers) {
    std::copy(multipliers.begin(), multipliers.end(), lambda.begin());
    std::copy(positions.begin(), positions.end(), x.begin());
  }
};

}  // namespace isochor
