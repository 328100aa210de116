// A scene taken through the same steps as World::compile(), with everything inside at hand.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/scene/builder.h"
#include "engine/solve/newton/newton.h"
#include "engine/system/system.h"
#include "isochor/effects.h"

namespace test {

struct Compiled {
  std::unique_ptr<isochor::Builder> builder = std::make_unique<isochor::Builder>();
  std::vector<std::unique_ptr<isochor::EffectInstance>> instances;
  std::shared_ptr<const isochor::System> system;
  std::string error;  // empty: all went well
};
// `anchored`: refuse what statics would refuse.
Compiled compile(const std::vector<isochor::BodyDef>& bodies, const std::vector<isochor::EffectPtr>& effects,
                 bool anchored = false, isochor::RowTreatment treatment = isochor::RowTreatment::automatic);

// The data of one increment at time t, held in its own arrays: what World::Impl hands to Newton.
struct ProblemData {
  std::vector<isochor::Vec3> predicted, force, position;
  std::vector<double> target, prescribed, memory;
  double mass_scale = 0;

  explicit ProblemData(const isochor::System& system);
  void at_time(const isochor::System& system, double t);
  isochor::SaddleProblem problem() const;
};

}  // namespace test
