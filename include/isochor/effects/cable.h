// Cables that slide through a body and threads that are bonded to it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "isochor/curves.h"
#include "isochor/effects/effect.h"
#include "isochor/export.h"
#include "isochor/ids.h"

namespace isochor {

enum class CableControl : std::uint8_t {
  tension,       // amount: tension [N]; below zero counts as zero
  length,        // amount: length [m]
  length_ratio,  // amount: length over rest length
};

// A cable that runs straight between points of a body and slides through them without friction: one tension
// along all of it. It pulls and never pushes; slack, it carries nothing.
struct CableDef {
  std::string name = "cable";
  BodyId body{};
  std::vector<Vec3> points;  // rest positions in or on the body [m], in order
  // Fixed points outside the body where the cable comes from and goes to (a motor, a wall).
  std::optional<Vec3> from, to;
  CableControl control = CableControl::length_ratio;
  Curve amount = Curve::constant(1);
  double stiffness = 0;  // of the whole cable under length control [N/m]; 0: inextensible
};
ISOCHOR_API EffectPtr cable(CableDef def);

// Threads that are bonded to the body along paths: every segment between two points has its own tension.
struct WindingDef {
  std::string name = "winding";
  BodyId body{};
  std::vector<std::vector<Vec3>> paths;  // rest positions in or on the body [m]
  double stiffness = 0;                  // tension over strain, E A [N]; 0: inextensible
  double slack = 0;                      // strain up to which a segment carries nothing
  bool pulls_only = true;                // false: it resists shortening too
};
ISOCHOR_API EffectPtr winding(WindingDef def);

// A spring between two points of bodies, or from a point to a fixed place: the tension stiffness * (length -
// amount * rest length) along the line between them.
struct SpringDef {
  std::string name = "spring";
  BodyId body{};
  Vec3 from{};                    // rest position in or on `body` [m]
  std::optional<BodyId> to_body;  // the body that `to` is of; none: a fixed place
  Vec3 to{};                      // [m]
  double stiffness = 0;           // [N/m], positive
  std::optional<double> length;   // without tension [m]; none: as long as it is at rest
  bool pulls_only = false;        // a rubber band: shorter than that it is slack
  Curve amount = Curve::constant(1);
};
ISOCHOR_API EffectPtr spring(SpringDef def);

// Points of a helix about the axis from `start` to `end`; without turns between them, of a straight line.
// `out` is where the first point lies from the axis; its length is the radius. Negative turns: left-handed.
ISOCHOR_API std::vector<Vec3> helix(const Vec3& start, const Vec3& end, const Vec3& out, double turns,
                                    int points);

}  // namespace isochor
