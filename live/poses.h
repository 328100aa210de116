// Where obstacles and supports are put by hand: moved, and turned about their middle, from where they are at
// rest. A support that holds single directions is moved along those alone, and turned in the plane of two:
// what it leaves free, no pose can give.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenes/scene.h"

namespace isochor::live {

// How something rigid has moved since rest.
struct Placement {
  Vec3 shift{};  // of its middle [m]
  Vec3 turn{};   // axis times angle [rad]
};

// One of the numbers that say where something is: a way along a direction [m], or a turn about it [rad].
struct PoseAxis {
  std::string name;
  Vec3 direction{};  // of unit length
  bool turn = false;

  double of(const Placement& p) const { return dot(turn ? p.turn : p.shift, direction); }
  void set(Placement& p, double value) const { (turn ? p.turn : p.shift) += (value - of(p)) * direction; }
};

class Poses {
 public:
  // `extent`: of the bodies [m]; a step moves what is put elsewhere by a part of it.
  Poses(const SceneDef& scene, const BuiltScene& built, double extent);

  std::size_t count() const { return things_.size(); }
  const std::string& name(std::size_t thing) const { return things_[thing].name; }
  // In which ways it can be moved.
  const std::vector<PoseAxis>& axes(std::size_t thing) const { return things_[thing].axes; }
  // The largest shift that the scene itself has for it [m].
  double reach(std::size_t thing) const;
  // Where it is wanted, or where the scene has it at that time.
  Placement wanted(std::size_t thing, double time) const;
  // From now on instead of what the scene says.
  void want(std::size_t thing, const Placement& placement) { things_[thing].wanted = placement; }
  // Before a step of length h: what is not where it is wanted comes nearer. Obstacles of `built` move along,
  // for those who draw them.
  Result<void> prepare(BuiltScene& built, double h);
  bool arrived(double time) const;
  // As the scene says it; for a world that is as the scene says it.
  void forget(BuiltScene& built);

 private:
  struct Thing {
    std::string name;
    const EffectKind* kind = nullptr;
    std::size_t place = 0;  // in the list of its kind
    Vec3 middle{};          // at rest [m]
    PoseTrack said, now;    // by the scene, and what counts
    std::vector<PoseAxis> axes;
    std::optional<Placement> wanted;
  };
  void add_obstacles(const SceneDef& scene, const BuiltScene& built);
  void add_supports(const SceneDef& scene, const BuiltScene& built);
  static Placement placement(const Thing& thing, double time);
  // Of the way that is left a step makes this part, 0: it is there.
  double stride(const Placement& from, const Placement& to) const;

  double extent_;
  std::vector<Thing> things_;
};

}  // namespace isochor::live
