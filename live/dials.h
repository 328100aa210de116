// What of a scene can be changed while it runs: amounts of its effects, poses, gravity, constants of
// materials, friction, damping.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "live/poses.h"

namespace isochor::live {

// A number with a slider. Values and bounds are in `unit`.
struct Dial {
  std::string group, name, unit;
  double low = 0, high = 1;
  bool logarithmic = false;
};

class Dials {
 public:
  // `stiffness`: of the spring by which points are pulled at [N/m]; `extent`: of the bodies [m].
  Dials(const SceneDef& scene, Poses& poses, double stiffness, double extent);
  Dials(const Dials&) = delete;
  Dials& operator=(const Dials&) = delete;

  const std::vector<Dial>& list() const { return list_; }
  // What the scene has, or what was set since.
  double value(std::size_t dial, double time) const;
  // Beyond the ends of a slider is refused, and so is what the world refuses; nothing is changed then.
  Result<void> set(std::size_t dial, double value, BuiltScene& built);
  // As the scene says it; for a world that is as the scene says it.
  void forget();
  double spring() const { return value(0, 0); }

 private:
  // Changes the world; the scene beside it holds what was set before.
  using Apply = std::function<Result<void>(double, SceneDef&, BuiltScene&)>;
  struct Work {
    std::function<double(double)> given;  // by the scene, at a time
    Apply apply;
    std::optional<double> set;
  };
  void add(Dial dial, std::function<double(double)> given, Apply apply);
  void add_amounts();
  void add_poses(double extent);
  void add_gravity();
  void add_materials();
  void add_friction();
  void add_damping();

  const SceneDef& scene_;
  Poses& poses_;
  SceneDef changed_;                           // with the constants that were set
  std::vector<std::optional<EffectId>> drag_;  // by body, where it was added here
  std::vector<Dial> list_;
  std::vector<Work> work_;
};

// A stiffness by which a point can be pulled at without leaving a dent: Young's modulus times the size of
// what is held.
double spring_for(const SceneDef& scene, double extent);

}  // namespace isochor::live
