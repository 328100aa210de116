#include <algorithm>
#include <cmath>

#include "studies/chaos/draft.h"

namespace isochor::studies {

namespace {

// An obstacle whose surface faces a body from outside: `side` points from the body to it.
Obstacle draw_obstacle(ChaosRandom& random, ChaosDraft& draft, const std::string& name, const DraftBody& body,
                       int axis, double sign) {
  Obstacle o;
  o.shape = static_cast<ObstacleShape>(random.whole(0, 6));
  const Vec3 size = body.upper - body.lower;
  Vec3 outward{};
  outward[axis] = sign;
  const double gap = random.pick({0.0, 0.0, 1e-3, 0.05, 0.3}) * size[axis];
  Vec3 face = body.middle();
  face[axis] = (sign > 0 ? body.upper[axis] : body.lower[axis]) + sign * gap;
  const double broad = std::max({size.x, size.y, size.z}) * random.pick({0.1, 0.3, 1.0, 3.0});
  double half = 0;  // from its middle to the surface that faces the body
  o.axis = outward;
  o.side = axis == 0 ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
  switch (o.shape) {
    case ObstacleShape::plane:
      o.axis = -outward;
      break;
    case ObstacleShape::sphere:
      half = o.radius = broad;
      break;
    case ObstacleShape::capsule:
      o.radius = 0.5 * broad;
      o.length = broad;
      half = o.radius + 0.5 * o.length;
      break;
    case ObstacleShape::cylinder:
      o.radius = 0.5 * broad;
      o.length = broad;
      half = 0.5 * o.length;
      if (random.chance(0.5)) o.rounding = 0.1 * broad;
      break;
    case ObstacleShape::box:
      o.size = {broad, broad * random.between(0.3, 1), broad};
      half = 0.5 * broad;
      if (random.chance(0.5)) o.rounding = 0.1 * broad;
      break;
    case ObstacleShape::mesh:
    case ObstacleShape::distance_field:
      o.file = draft.add_surface_file(random, name, {broad, broad, broad});
      if (o.shape == ObstacleShape::distance_field) o.spacing = broad / random.whole(5, 10);
      half = 0.5 * broad;
      break;
  }
  o.position = face + half * outward;
  return o;
}

// Methods that rest on symmetric matrices refuse coupled friction; a few such scenes are enough.
bool coupling_fits(ChaosRandom& random, const ChaosDraft& draft) {
  const AnalysisDef& a = draft.out.scene.analysis;
  const bool unsymmetric = a.options.method == Method::automatic ||
                           a.options.method == Method::saddle_point ||
                           a.options.method == Method::condensation;
  return (unsymmetric && a.options.solver != Solver::iterative && !a.path_step) || random.chance(0.03);
}

void draw_friction(ChaosRandom& random, const ChaosDraft& draft, ContactDef& def) {
  if (random.chance(0.5)) {
    def.friction = random.pick({0.05, 0.3, 0.8, 3.0});
    if (random.chance(0.3)) def.static_friction = 1.5 * def.friction;
    if (random.chance(0.3) && coupling_fits(random, draft)) def.coupling = FrictionCoupling::coupled;
    if (random.chance(0.1)) def.stick_stiffness = draft.young / draft.length * random.decades(-1, 4);
  }
  if (random.chance(0.3)) def.compliance = draft.length / draft.young * random.decades(-6, 0);
  if (draft.dynamic && def.compliance == 0 && random.chance(0.25)) def.restitution = random.between(0, 1);
}

void obstacle_contact(ChaosRandom& random, ChaosDraft& draft, std::size_t b) {
  const DraftBody& body = draft.bodies[b];
  ContactDef def;
  def.name = "contact" + std::to_string(draft.scene().contacts.size());
  def.body = static_cast<BodyId>(b);
  const int axis = random.pick({0, 1, 2, 2, 2});
  const double sign = random.chance(0.5) ? 1 : -1;
  def.obstacle = draw_obstacle(random, draft, def.name, body, axis, sign);
  if (random.chance(0.65)) {
    const double extent = body.upper[axis] - body.lower[axis];
    Vec3 way{};
    way[axis] = -sign * extent * (random.chance(0.85) ? random.decades(-2, 0) : random.decades(0, 2));
    if (random.chance(0.3)) way += random.between(0, 0.5) * extent * random.direction();
    def.obstacle.motion.file = draft.add_motion(random, def.name, way);
  }
  draw_friction(random, draft, def);
  if (random.chance(0.15)) {
    def.initial_overlap = InitialOverlap::resolve;
    def.resolve_time = draft.duration * random.pick({0.5, 1.0});
    def.obstacle.position[axis] -= sign * 0.05 * (body.upper[axis] - body.lower[axis]);
  }
  draft.scene().contacts.push_back(std::move(def));
}

void rigid(ChaosRandom& random, ChaosDraft& draft) {
  const DraftBody& body = draft.bodies.back();
  RigidBodyDef def;
  def.name = "rigid";
  do {
    def.shape = draw_obstacle(random, draft, def.name, body, 2, 1);
  } while (def.shape.shape == ObstacleShape::plane);
  def.density = draft.density * random.decades(-1, 2);
  draft.scene().rigid_bodies.push_back(def);
  ContactDef contact;
  contact.name = "on_rigid";
  contact.body = static_cast<BodyId>(draft.bodies.size() - 1);
  contact.against = def.name;
  draw_friction(random, draft, contact);
  draft.scene().contacts.push_back(contact);
  if (!random.chance(0.3)) return;
  ContactDef floor;
  floor.name = "rigid_floor";
  floor.rigid = def.name;
  floor.obstacle.position = draft.bodies.front().lower;
  draw_friction(random, draft, floor);
  draft.scene().contacts.push_back(floor);
}

void surfaces(ChaosRandom& random, ChaosDraft& draft, std::size_t b, bool itself) {
  SurfaceContactDef def;
  def.name = "surfaces" + std::to_string(draft.scene().surface_contacts.size());
  def.body = static_cast<BodyId>(b);
  if (!itself) def.against = static_cast<BodyId>(b - 1);
  if (random.chance(0.3)) def.compliance = draft.length / draft.young * random.decades(-6, 0);
  if (random.chance(0.15)) def.thickness = draft.length * random.decades(-4, -2);
  if (random.chance(0.4)) {
    def.friction = random.pick({0.05, 0.3, 0.8});
    if (random.chance(0.3) && coupling_fits(random, draft)) def.coupling = FrictionCoupling::coupled;
  }
  if (random.chance(0.5)) {
    def.initial_overlap = InitialOverlap::resolve;
    def.resolve_time = draft.duration;
  }
  draft.scene().surface_contacts.push_back(def);
}

}  // namespace

void draft_contacts(ChaosDraft& draft) {
  ChaosRandom random = draft.random("contacts");
  const bool follows = draft.out.scene.analysis.path_step.has_value();  // surfaces are refused there
  for (std::size_t b = 0; b < draft.bodies.size(); ++b) {
    const int contacts = random.pick({0, 0, 0, 1, 1, 2});
    for (int c = 0; c < (b == 0 ? contacts : contacts / 2); ++c) obstacle_contact(random, draft, b);
    const bool apart = b > 0 && !draft.scene().ties.empty() && random.chance(0.9);
    if (b > 0 && !apart && !follows && random.chance(0.6)) surfaces(random, draft, b, false);
    if (!follows && random.chance(0.07)) surfaces(random, draft, b, true);
  }
  if (draft.dynamic ? random.chance(0.12) : random.chance(0.01)) rigid(random, draft);
}

}  // namespace isochor::studies
