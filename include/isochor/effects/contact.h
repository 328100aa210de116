// Rigid bodies, and contact of soft bodies with them, with obstacles and with each other.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "isochor/effects/effect.h"
#include "isochor/export.h"
#include "isochor/ids.h"
#include "isochor/poses.h"
#include "isochor/solids.h"

namespace isochor {

enum class ObstacleShape : std::uint8_t {
  plane,           // solid below its own x-y plane
  sphere,          // radius
  capsule,         // radius around a segment of `length` along its own z axis
  cylinder,        // radius, `length` along its own z axis
  box,             // edges `size` along its own axes
  mesh,            // a closed triangle surface: `solid` from mesh_solid()
  distance_field,  // distances on a grid: `solid` from field_solid()
};

// A rigid body that is where it is told to be.
struct Obstacle {
  ObstacleShape shape = ObstacleShape::plane;
  Vec3 position{};     // of its own origin, the middle of the shape [m]
  Vec3 axis{0, 0, 1};  // direction of its own z axis: normal of a plane, axis of a capsule or cylinder
  Vec3 side{1, 0, 0};  // its own x axis, as far as it is perpendicular to `axis`
  double radius = 0;   // [m]
  double length = 0;   // [m], of a capsule between the middles of its ends
  Vec3 size{};         // [m], full edges of a box
  // [m]: radius of the edges of cylinders and boxes, inside the size given. Meshes and distance fields grow
  // by it on all sides.
  double rounding = 0;
  // Of a mesh or a distance field, in its own axes.
  SolidPtr solid;
  // Only scene files use these: where the solid is read from, what its coordinates are multiplied by, and for
  // a distance field made from a surface the spacing of its points [m].
  std::string file;
  double scale = 1;
  double spacing = 0;
  // Moves it; at the first keyframe it is as described above. Empty: it rests.
  PoseTrack motion;
};

// What becomes of nodes that are inside the obstacle at the start.
enum class InitialOverlap : std::uint8_t {
  report,   // refused, with node and depth
  resolve,  // pushed out little by little until `resolve_time`
};

// A rigid body that moves by the forces on it; dynamics only. It touches what contacts with its name say.
struct RigidBodyDef {
  std::string name = "rigid";
  Obstacle shape;         // any but a plane, where it is at rest; no motion of its own
  double density = 1000;  // [kg/m^3]
};
ISOCHOR_API EffectPtr rigid_body(RigidBodyDef def);

// How the linear systems see that friction depends on the normal force and turns with the surface. Both end
// at the same solution.
enum class FrictionCoupling : std::uint8_t {
  lagged,   // these are held within an iteration: symmetric systems with a merit. Corrections between
            // iterations know them, on the factors at hand
  coupled,  // they are part of the linear system, which is unsymmetric: quadratic convergence, no inertia of
            // the whole to watch. Solved on the symmetric factors, or by LU where that does not converge
};

// Nodes of a body's surface against one obstacle: they do not enter it, it does not pull, and friction holds
// or brakes them. Add supports first: nodes that are held in all directions are left out.
struct ContactDef {
  std::string name = "contact";
  BodyId body{};
  std::vector<std::string> surfaces;  // empty: the whole boundary of the body
  Obstacle obstacle;
  // Names of free rigid bodies that were added before: one in place of `body`, one in place of `obstacle`. A
  // rigid body touches with points of its shape: a sphere and the round ends of a capsule exactly, boxes and
  // cylinders with their corners and rims, meshes with their points.
  std::string rigid, against;
  double compliance = 0;  // [m/Pa]: depth over pressure of a soft layer; 0: hard
  double friction = 0;    // coefficient of Coulomb friction [-]
  // Coefficient that it takes to break away [-], not below `friction`; 0: the same. A point that slipped in
  // one step has `friction` in the next, one that stuck or did not touch has this.
  double static_friction = 0;
  // Of friction below its limit, shear stress over slip [Pa/m]: the slip that remains when it sticks is
  // elastic. 0: a hundred times the shear modulus over the size of a face.
  double stick_stiffness = 0;
  FrictionCoupling coupling = FrictionCoupling::lagged;
  // Newton's coefficient of restitution e [-], 0 to 1: what closes at a speed u beyond `restitution_speed`
  // opens at e u behind the impact. Hard contact in dynamics, each point by itself: a rigid body bounces, of
  // a soft one the nodes do, while the body behind them is as elastic as it is.
  double restitution = 0;
  double restitution_speed = 0.05;  // [m/s]
  InitialOverlap initial_overlap = InitialOverlap::report;
  double resolve_time = 1;  // [s]; statics: load factor
};
ISOCHOR_API EffectPtr contact(ContactDef def);

// Surfaces of soft bodies against each other, or that of one body against itself. Both sides are integrated
// over with points at corners, edges and middles of triangles (faces of more nodes are split), each with a
// row of its own, so that neither is master or slave. The layer between them has a compliance always.
struct SurfaceContactDef {
  std::string name = "surface_contact";
  BodyId body{};
  std::vector<std::string> surfaces;  // empty: the whole boundary of the body
  // The other side; empty: `surfaces` touch each other, a body itself.
  std::optional<BodyId> against;
  std::vector<std::string> against_surfaces;  // empty: the whole boundary of that body
  // [m/Pa]: depth over pressure. Not given: that of a layer two percent of a face thick, of the softer body.
  std::optional<double> compliance;
  double thickness = 0;        // [m]: distance that the surfaces keep
  double friction = 0;         // as in ContactDef
  double static_friction = 0;  // as in ContactDef
  double stick_stiffness = 0;  // as in ContactDef
  FrictionCoupling coupling = FrictionCoupling::lagged;
  InitialOverlap initial_overlap = InitialOverlap::report;
  double resolve_time = 1;  // [s]; statics: load factor
};
ISOCHOR_API EffectPtr surface_contact(SurfaceContactDef def);

}  // namespace isochor
