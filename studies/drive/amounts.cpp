#include "studies/drive/amounts.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text.h"
#include "scenes/effects/kind.h"
#include "studies/drive/drive.h"

namespace isochor::drive {

FoundAmount find_amount(SceneDef& scene, const std::string& name) {
  FoundAmount out;
  const auto look = [&](auto& list, const EffectKind& kind) {
    for (std::size_t k = 0; k < list.size() && !out.amount; ++k) {
      if (list[k].name == name) out = {&list[k].amount, &kind, k};
    }
  };
  look(scene.cavities, cavities_kind);
  look(scene.cables, cables_kind);
  look(scene.pressures, pressures_kind);
  look(scene.tractions, tractions_kind);
  look(scene.forces, forces_kind);
  look(scene.dirichlet, dirichlet_kind);
  look(scene.valves, valves_kind);
  return out;
}

std::string names_with_amounts(SceneDef& scene) {
  std::string names;
  for (const EffectKind* kind : effect_kinds) {
    for (std::size_t k = 0; k < kind->size(scene); ++k) {
      const std::string& name = kind->name(scene, k);
      if (find_amount(scene, name).amount) names += (names.empty() ? "\"" : ", \"") + name + "\"";
    }
  }
  return names.empty() ? "none" : names;
}

double size_of(const Actuator& actuator, double start) {
  const double range = actuator.most - actuator.least;
  return std::isfinite(range) ? range : std::max(1.0, std::abs(start));
}

Result<void> check_actuators(SceneDef& scene, const std::vector<Actuator>& actuators) {
  if (actuators.empty()) return Error{"drive: no amount may be chosen; name at least one with --amount"};
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    const Actuator& a = actuators[i];
    for (std::size_t k = 0; k < i; ++k) {
      if (actuators[k].effect == a.effect)
        return Error{"drive: --amount \"" + a.effect + "\" is there twice; keep one"};
    }
    const FoundAmount found = find_amount(scene, a.effect);
    if (!found.amount) {
      return Error{"drive: the scene has no effect \"" + a.effect + "\" with an amount; it has " +
                   names_with_amounts(scene)};
    }
    const double start = evaluate(*found.amount, 0);
    if (!(start >= a.least && start <= a.most)) {
      return Error{"drive: the amount of \"" + a.effect + "\" begins at " + number(start) +
                   ", outside of its bounds " + number(a.least) + " to " + number(a.most) +
                   "; widen them, or begin elsewhere with --set"};
    }
    if (!(size_of(a, start) > 0))
      return Error{"drive: the bounds of \"" + a.effect + "\" leave it no choice; widen them"};
  }
  return {};
}

Eigen::VectorXd units_of(const Targets& targets) {
  const std::size_t goals = targets.goals.size();
  Eigen::VectorXd units = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(goals));
  for (std::size_t g = 0; g < goals; ++g) {
    const auto kind = targets.goals[g].kind;
    if (kind == inverse::Quantity::Kind::position) continue;
    double most = 0;
    for (const std::vector<double>& values : targets.value) {
      for (std::size_t k = 0; k < goals; ++k) {
        if (targets.goals[k].kind == kind) most = std::max(most, std::abs(values[k]));
      }
    }
    if (most > 0) units[static_cast<Eigen::Index>(g)] = most;
  }
  return units;
}

Result<void> check_distances(const World& world, const Targets& targets, const Eigen::VectorXd& now) {
  constexpr double farthest = 100;  // over the size of the bodies
  Vec3 lower{HUGE_VAL, HUGE_VAL, HUGE_VAL}, upper = -1.0 * lower;
  for (const BodyId body : world.bodies()) {
    for (const Vec3& X : world.rest_positions(body)) {
      for (int k = 0; k < 3; ++k) {
        lower[k] = std::min(lower[k], X[k]);
        upper[k] = std::max(upper[k], X[k]);
      }
    }
  }
  const Vec3 size = upper - lower;
  const double length = std::sqrt(dot(size, size));
  for (std::size_t step = 0; step < targets.time.size(); ++step) {
    for (std::size_t g = 0; g < targets.goals.size(); ++g) {
      if (targets.goals[g].kind != inverse::Quantity::Kind::position) continue;
      const double target = targets.value[step][g],
                   away = std::abs(target - now[static_cast<Eigen::Index>(g)]);
      if (away <= farthest * length) continue;
      return Error{"drive: target " + targets.goals[g].name + " = " + number(target) +
                   " at t = " + number(targets.time[step]) + " is " + number(away) +
                   " m from where the probe begins, and the scene is " + number(length) +
                   " m across; targets are positions in meters"};
    }
  }
  return {};
}

}  // namespace isochor::drive
