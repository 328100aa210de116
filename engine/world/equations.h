// The equations of a scene at the state of a world, and a changed scene beside the present one.
#pragma once

#include "engine/world/watched.h"
#include "engine/world/world_impl.h"

namespace isochor {

// R = (force, theta), and what is given. A change of them by a parameter is one of these as well.
struct Equations {
  std::vector<Vec3> force;     // of all nodes: d(energy + lambda . phi)/dx less loads [N]
  std::vector<double> theta;   // phi - target - C lambda
  std::vector<Vec3> position;  // targets of given nodes, as SaddleProblem::position
  std::vector<double> seen;    // of what somebody watches
  std::vector<double> kept;    // what materials remember at the end of the increment (MemoryTerms)

  Equations() = default;
  explicit Equations(const System& s, std::size_t watched = 0);
  void add(double factor, const Equations& other);
};

// What an increment in which bodies move adds at the place where it is evaluated.
struct Inertia {
  double mass_scale = 0;        // [1/s^2]
  std::vector<Vec3> predicted;  // [m]
  StencilIncrement increment;   // what stencils look back over
  void add_to(SaddleProblem& problem) const {
    problem.mass_scale = mass_scale;
    problem.predicted = predicted;
    problem.increment = increment;
  }
};

// Who evaluates them.
struct EquationsAt {
  const System& system;
  Assembly& assembly;
  IncrementData& data;
  const std::vector<std::unique_ptr<EffectInstance>>& instances;
  const Builder& builder;
  const Inertia* inertia = nullptr;  // null: there is none
};
Equations equations_at(const EquationsAt& where, const State& state, std::span<const Watched> watched);

}  // namespace isochor
