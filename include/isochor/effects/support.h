// Positions that are given, and bodies held to each other.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "isochor/curves.h"
#include "isochor/effects/effect.h"
#include "isochor/export.h"
#include "isochor/ids.h"
#include "isochor/poses.h"
#include "isochor/selection.h"

namespace isochor {

// How prescribed positions enter the system.
enum class SupportTreatment : std::uint8_t {
  eliminated,  // no unknowns; exact, reactions are reported
  multiplier,  // hard rows, the reactions are unknowns: for points inside elements, and beside other supports
  stiffness,   // compliant rows: springs to the prescribed positions, the soft attachment to a bone
};

// Prescribed positions, by default eliminated from the unknowns; reactions are reported.
struct DirichletDef {
  std::string name = "fixed";
  Selection where;
  // Directions that are given; empty: all three. Need not be orthogonal or unit length.
  std::vector<Vec3> directions;
  // Displacement [m] at amount 1, and a rotation [rad] about an axis at amount 1; both zero: held in place.
  Vec3 displacement{};
  Vec3 axis_point{}, axis{};
  double angle = 0;
  // Instead of displacement and angle: the nodes move with this bone.
  PoseTrack bone;
  // Scales displacement and angle over time; a bone has its own times.
  Curve amount = Curve::constant(1);
  SupportTreatment treatment = SupportTreatment::eliminated;
  // Of treatment `stiffness`: of all springs together, along each direction [N/m].
  double stiffness = 0;
  // Points anywhere in the body, held like nodes; not with treatment `eliminated`. With points the selection
  // may be empty.
  std::vector<Vec3> points;
};
ISOCHOR_API EffectPtr dirichlet(DirichletDef def);

// Holds nodes of one body to the material points of another (or the same) that they lie on at rest.
struct TieDef {
  std::string name = "tie";
  Selection where;       // nodes that are attached
  BodyId to{};           // the body that holds the points
  double stiffness = 0;  // of all springs together [N/m]; 0: hard
};
ISOCHOR_API EffectPtr tie(TieDef def);

}  // namespace isochor
