// What a search for amounts has in hand: curves of effects, units of goals.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "studies/drive/targets.h"

namespace isochor {
struct EffectKind;
}

namespace isochor::drive {

struct Actuator;

// The amount of the first effect of a name that has one, and which of its kind that is; null: there is none.
struct FoundAmount {
  Curve* amount = nullptr;
  const EffectKind* kind = nullptr;
  std::size_t number = 0;
};
FoundAmount find_amount(SceneDef& scene, const std::string& name);
// The names of all that have one, in quotes.
std::string names_with_amounts(SceneDef& scene);

// What every search refuses: amounts that are not there, or twice, or begin outside of their bounds; none.
Result<void> check_actuators(SceneDef& scene, const std::vector<Actuator>& actuators);
// An amount's bounds apart, or else what it begins with.
double size_of(const Actuator& actuator, double start);

// Of each goal what counts as 1: a meter, or the largest target of its kind.
Eigen::VectorXd units_of(const Targets& targets);
// Millimeters for meters, say: no amount brings a probe that far. `now`: of each goal.
Result<void> check_distances(const World& world, const Targets& targets, const Eigen::VectorXd& now);

}  // namespace isochor::drive
