// What a viewer does to a body by hand: springs that pull at a point, pins, spheres that push.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "results_page.h"
#include "scenes/scene.h"

namespace isochor::live {

enum class HandleKind : std::uint8_t { pull, pin, push };

// A point of a surface as it is drawn.
struct Hit {
  std::size_t body = 0;
  Vec3 rest{}, now{};  // [m]
  Vec3 normal{};       // outward, now
  double size = 0;     // the longest side of the triangle [m]
};

struct HandleState {
  int id = 0;
  HandleKind kind = HandleKind::pull;
  Vec3 at{}, to{};    // where the point is, and where it is wanted [m]; of a sphere its middle
  double force = 0;   // [N]
  double radius = 0;  // of a sphere, or of the patch that is held [m]
};

class Hand {
 public:
  static constexpr std::size_t most = 16;  // handles at a time

  // `extent`: of the whole scene [m].
  explicit Hand(double extent = 1) : extent_(extent) {}

  // `stiffness`: of the spring of a pull [N/m]; pins are a good deal stiffer.
  Result<int> hold(HandleKind kind, const Hit& hit, double stiffness, BuiltScene& built);
  Result<void> move(int id, const Vec3& to);
  Result<void> release(int id, BuiltScene& built);
  // Before a step: what is held follows its body and comes nearer to where it is wanted.
  Result<void> prepare(BuiltScene& built);
  // Whether all of it is where it is wanted.
  bool arrived() const;
  void forget();  // with the world in which they were

  std::vector<HandleState> states(const BuiltScene& built) const;
  bool empty() const { return held_.empty(); }

 private:
  struct Held {
    HandleState state;
    EffectId effect{};
    BodyId body{};
    Selection patch;  // nodes that are held
    Vec3 rest{};      // the point at rest; of a sphere its middle at the start
    Vec3 reached{};   // where the last step had it
  };
  std::optional<std::size_t> find(int id) const;
  Result<int> pull(HandleKind kind, const Hit& hit, double stiffness, BuiltScene& built);
  Result<int> push(const Hit& hit, BuiltScene& built);

  double extent_;
  int next_ = 1;
  std::vector<Held> held_;
};

}  // namespace isochor::live
