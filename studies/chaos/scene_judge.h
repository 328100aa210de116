// What must hold of the states of a scene: that of judge.h, and supports, obstacles, volume and energy as the
// scene asks for them.
#pragma once

#include "scenes/scene.h"
#include "studies/chaos/distances.h"
#include "studies/judge.h"

namespace isochor::studies {

class SceneJudge {
 public:
  // Remembers the energy at the start.
  SceneJudge(const SceneDef& scene, const BuiltScene& built);

  // Of a state that a step converged to.
  std::optional<Finding> accepted(const BuiltScene& built, std::span<const std::string> said);
  std::optional<Finding> finite(const BuiltScene& built) const { return state_.finite(built.world); }
  // As StateJudge::numbers(), with the reactions of supports.
  std::optional<Finding> numbers(const BuiltScene& built) const;
  // The smallest J of all bodies, how many cells are inverted, and how many may be so for all that rounding
  // tells.
  struct Inversion {
    double min_J;
    std::int64_t inverted, flat;
    bool agrees(const StepReport& report) const;
  };
  Inversion inversion(const World& world) const;

 private:
  // What to ask later, found out at the start.
  void watch_volume(std::size_t body);
  void watch_energy(const BuiltScene& built, std::size_t body);
  void watch_supports(const BuiltScene& built);
  void watch_contacts(const BuiltScene& built);
  std::optional<Finding> volume(const World& world, std::size_t body) const;
  std::optional<Finding> support(const World& world, std::size_t def) const;
  std::optional<Finding> driven(const World& world, std::size_t def) const;
  std::optional<Finding> obstacle(const BuiltScene& built, std::size_t contact) const;
  std::optional<Finding> energy(const World& world);
  std::optional<Finding> balance(const BuiltScene& built) const;
  double weight_gone_down(const World& world) const;

  SceneDef scene_;  // poses read
  StateJudge state_;
  JudgeLimits limits_;
  std::vector<bool> exact_volume_;             // of a body: its rows keep it
  std::vector<bool> log_volume_;               // by log J
  std::vector<std::vector<Index>> supported_;  // nodes of each support that must be at their targets
  std::vector<std::vector<std::size_t>>
      followed_;                                  // of nodes that follow data: those that nothing else moves
  std::vector<std::vector<bool>> held_;           // nodes of each body that some support moves or holds
  std::vector<std::vector<Index>> touching_;      // nodes of each contact that must stay out of its obstacle
  std::vector<std::vector<ConvexPlane>> planes_;  // of obstacles given by surfaces that are convex
  double length_ = 1;                             // of the scene [m]
  // Energy that may be there: nothing works on the scene but gravity.
  bool isolated_ = false;
  double start_energy_ = 0, most_gone_down_ = 0, energy_noise_ = 0;
  double grown_energy_ = 0;  // that bodies which grow may hold [J]
  // Statics where supports alone carry what loads, whose resultant is known, put on the bodies.
  bool carried_by_supports_ = false;
  std::vector<double> mass_;  // of bodies [kg]
  std::vector<Vec3> center_;
};

}  // namespace isochor::studies
