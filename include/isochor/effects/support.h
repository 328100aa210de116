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

// One linear equation between displacements u of points: sum of weight * direction . u = amount * value.
struct LinearConstraintDef {
  struct Term {
    BodyId body{};
    Vec3 point{};             // rest position in or on the body [m]
    Vec3 direction{1, 0, 0};  // any length but zero; its length does not count
    double weight = 1;
  };
  std::string name = "constraint";
  std::vector<Term> terms;
  double value = 0;      // [m] at amount 1
  double stiffness = 0;  // [N/m]: a spring on the sum; 0: hard
  Curve amount = Curve::constant(1);
};
ISOCHOR_API EffectPtr linear_constraint(LinearConstraintDef def);

// Nodes that follow data: positions frame by frame, linear between frames and at rest before and after.
struct DrivenDef {
  std::string name = "driven";
  BodyId body{};
  std::vector<Index> nodes;                  // of the body's mesh, counted from 0
  std::vector<double> times;                 // of the frames, ascending [s]; statics: load factor
  std::vector<std::vector<Vec3>> positions;  // a list a frame, one a node [m]
  std::string file = {};                     // where they are read from; only scene files use it
};
ISOCHOR_API EffectPtr driven(DrivenDef def);

// Reads lines "t, node, x, y, z" in seconds and meters, frame after frame with the same nodes; a first line
// of names and lines that begin with # are skipped. Leaves name and body as they are by default.
ISOCHOR_API Result<DrivenDef> read_driven(const std::string& path);

// Nodes that follow several bones, each by a weight: linear blend skinning, x = sum of w_b T_b(X) over the
// sum of the w_b.
struct SkinDef {
  struct Bone {
    PoseTrack track;              // the first keyframe is the pose in which the body was meshed
    std::vector<double> weights;  // one a node of the body's mesh, not negative
    std::string field;            // instead: a field of the mesh at nodes, with one component
  };
  std::string name = "skin";
  Selection where;  // nodes that follow; each needs a positive weight of some bone
  std::vector<Bone> bones;
};
ISOCHOR_API EffectPtr skin(SkinDef def);

}  // namespace isochor
