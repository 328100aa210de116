// Supports by rows, ties, cables, threads, chambers with content.
#include "contract/registry.h"
#include "engine/mesh/boundary.h"
#include "isochor/contact.h"
#include "support/meshes.h"

namespace test {

namespace {

using namespace isochor;

MaterialPtr soft() {
  ElasticConstants c;
  c.young = 2.6;
  c.poisson = 0.3;
  return std::move(neo_hookean(c)).value();
}

SceneCase on_block(const std::string& name, Element element, std::vector<std::string> covers,
                   EffectPtr effect) {
  const CellType type = element == Element::tet10 ? CellType::tet10 : CellType::tet4;
  return {name,    std::move(covers),    mapped(box({2, 1, 2}, {1, 0.5, 1}, type), wavy),
          element, {{"", soft(), 1000}}, {std::move(effect)}};
}

DirichletDef rows_def(SupportTreatment treatment) {
  DirichletDef def;
  def.name = treatment == SupportTreatment::multiplier ? "by multipliers" : "by springs";
  def.where.surfaces = {"x0"};
  def.directions = {{1, 0.2, 0}, {0, 0.3, 1}};
  def.points = {{0.71, 0.22, 0.43}};
  def.treatment = treatment;
  def.stiffness = treatment == SupportTreatment::stiffness ? 3 : 0;
  def.bone.keys = {{0, {0, 0, 0}, {1, 0, 0, 0}}, {1, {0.1, 0, 0.05}, {0.8, 0, 0.6, 0}}};
  return def;
}

void add_held(std::vector<SceneCase>& out, Element element) {
  for (const auto treatment : {SupportTreatment::multiplier, SupportTreatment::stiffness}) {
    SceneCase c =
        on_block("support by rows, treatment " + std::to_string(static_cast<int>(treatment)), element,
                 {"constraints/dirichlet", "constraints/point_pool"}, dirichlet(rows_def(treatment)));
    c.rigid_invariant = false;  // compared with places in space
    out.push_back(c);
  }
  DirichletDef bone = rows_def(SupportTreatment::eliminated);
  bone.points.clear();
  out.push_back(on_block("support on a bone", element, {"constraints/dirichlet"}, dirichlet(bone)));
  for (const double stiffness : {0.0, 5.0}) {
    TieDef def;
    def.where.surfaces = {"x1"};
    def.to = BodyId{1};
    def.stiffness = stiffness;
    SceneCase c = on_block("tie, stiffness " + std::to_string(stiffness), element,
                           {"constraints/tie", "constraints/point_pool"}, tie(def));
    c.more_bodies = {mapped(c.mesh, [](const Vec3& p) { return p + Vec3{0.813, 0.021, -0.017}; })};
    c.rigid_invariant = false;  // a gap turns with the bodies, the axes along which it is measured do not
    out.push_back(c);
  }
}

void add_threads(std::vector<SceneCase>& out, Element element) {
  const std::vector<std::string> covers = {"constraints/segment_pool"};
  const auto with = [&](const std::string& unit) {
    auto all = covers;
    all.push_back(unit);
    return all;
  };
  for (const auto control : {CableControl::tension, CableControl::length_ratio}) {
    for (const bool anchored : {false, true}) {
      CableDef def;
      def.points = {{0.11, 0.12, 0.13}, {0.42, 0.31, 0.57}, {0.81, 0.22, 0.84}};
      def.control = control;
      def.amount = Curve::constant(0.9);
      if (anchored) def.from = Vec3{-1, 0.2, 0.1};
      if (anchored) def.to = Vec3{1.4, 0.3, 2};
      if (control != CableControl::tension && anchored) def.stiffness = 4;
      SceneCase c = on_block(
          "cable, control " + std::to_string(static_cast<int>(control)) + (anchored ? ", fixed ends" : ""),
          element, with("constraints/cable"), cable(def));
      c.rigid_invariant = !anchored;
      out.push_back(c);
    }
  }
  WindingDef wound;
  wound.paths = {helix({0, 0.25, 0.5}, {1, 0.25, 0.5}, {0, 0.17, 0.11}, 1.3, 9),
                 {{0.2, 0.1, 0.2}, {0.9, 0.4, 0.7}}};
  out.push_back(on_block("winding, inextensible", element, with("constraints/threads"), winding(wound)));
  wound.stiffness = 2;
  wound.slack = 0.02;
  wound.pulls_only = false;
  SceneCase elastic = on_block("winding, elastic", element, with("constraints/threads"), winding(wound));
  out.push_back(elastic);
  StrainLimitDef layer;
  layer.surfaces = {"z0"};
  layer.stiffness = 1.5;
  out.push_back(on_block("layer", element, with("constraints/threads"), strain_limit(layer)));
}

void add_chambers(std::vector<SceneCase>& out, Element element) {
  const CellType type = element == Element::tet10 ? CellType::tet10 : CellType::tet4;
  const auto smaller = [](const Vec3& p) { return wavy((1.0 / 3) * p); };
  for (const auto control : {CavityControl::pressure, CavityControl::gas, CavityControl::liquid}) {
    CavityDef def;
    def.surfaces = {"chamber"};
    def.control = control;
    def.amount = Curve::constant(1.2);
    def.cap_free_openings = true;
    def.polytropic = 1.4;
    if (control != CavityControl::gas) {
      def.density = 1.3;
      def.gravity = {0.2, -0.4, 1};
    }
    ValveDef leak;
    leak.from = def.name;
    leak.conductance = 0.1;
    SceneCase c{"chamber with content, control " + std::to_string(static_cast<int>(control)),
                {"constraints/cavity", "constraints/chamber_caps", "constraints/chamber_network",
                 "constraints/chamber_surface", "constraints/face_pool"},
                mapped(hollow_box(true, type), smaller),
                element,
                {{"", soft(), 1000}},
                {cavity(def)}};
    if (control != CavityControl::pressure) c.effects.push_back(valve(leak));
    c.stress_free = false;
    c.rigid_invariant = def.density == 0;
    out.push_back(c);
  }
}

// A block with a step, so that it is not convex, or distances to it.
SolidPtr step_solid(ObstacleShape shape, double size) {
  TriangleSurface s = boundary_of(without_cells(box({2, 1, 2}), {0.5, -1, 0.5}, {2, 2, 2}, "step"));
  for (Vec3& p : s.points) p = size * (p - Vec3{0.5, 0.5, 0.5});
  if (shape == ObstacleShape::mesh) return std::move(mesh_solid(s)).value();
  return std::move(field_solid(std::move(sampled_distances(s, 0.13 * size)).value())).value();
}

bool is_solid(ObstacleShape shape) {
  return shape == ObstacleShape::mesh || shape == ObstacleShape::distance_field;
}

void add_contacts(std::vector<SceneCase>& out, Element element) {
  for (const auto shape :
       {ObstacleShape::plane, ObstacleShape::sphere, ObstacleShape::capsule, ObstacleShape::cylinder,
        ObstacleShape::box, ObstacleShape::mesh, ObstacleShape::distance_field}) {
    ContactDef def;
    def.obstacle.shape = shape;
    def.obstacle.position = {0.2, 0.3, -1.7};
    def.obstacle.axis = {0.1, 0.2, 1};
    def.obstacle.radius = 0.4;
    def.obstacle.length = 0.7;
    def.obstacle.size = {0.9, 0.7, 0.5};
    if (shape == ObstacleShape::box) def.obstacle.rounding = 0.05;
    if (is_solid(shape)) def.obstacle.solid = step_solid(shape, 0.8);
    def.obstacle.motion.keys = {{0, {0, 0, 0}, {1, 0, 0, 0}}, {1, {0.1, 0, 0.05}, {0.8, 0, 0.6, 0}}};
    def.friction = 0.3;
    if (shape == ObstacleShape::sphere) def.compliance = 1e-3;
    SceneCase c =
        on_block("contact, shape " + std::to_string(static_cast<int>(shape)), element,
                 {"constraints/contact", "constraints/rigid_geometry", "constraints/contact_frame",
                  "constraints/contact_intrusion", "constraints/contact_rows", "constraints/flush_nodes",
                  "constraints/obstacle_shape", "constraints/surface_nodes", "constraints/solid",
                  "constraints/mesh_solid", "constraints/closed_surface", "constraints/field_solid"},
                 contact(def));
    c.stress_free = c.rigid_invariant = false;  // distances to something that does not move with the body
    out.push_back(c);
    if (element != Element::tet4) continue;
    def.coupling = FrictionCoupling::coupled;
    c.name += ", coupled";
    c.covers = {"constraints/rigid_touch"};
    c.effects.back() = contact(def);
    out.push_back(c);
  }
}

// Two bodies a little apart.
void add_surface_contacts(std::vector<SceneCase>& out, Element element) {
  for (const double friction : {0.0, 0.4}) {
    SurfaceContactDef def;
    def.against = static_cast<BodyId>(1);
    def.friction = friction;
    def.coupling = FrictionCoupling::coupled;
    def.thickness = 0.02;
    def.initial_overlap = InitialOverlap::resolve;
    SceneCase c =
        on_block(friction > 0 ? "surface contact with friction" : "surface contact", element,
                 {"constraints/surface_contact", "constraints/surface_contact_pool",
                  "constraints/contact_surface", "constraints/patch_distance", "constraints/patch_touch",
                  "constraints/patch_geometry", "constraints/pairing", "constraints/contact_effect"},
                 surface_contact(def));
    Vec3 low = c.mesh.nodes.front(), high = low;
    for (const Vec3& p : c.mesh.nodes) {
      for (int k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], p[k]);
        high[k] = std::max(high[k], p[k]);
      }
    }
    c.more_bodies.push_back(mapped(c.mesh, [&](const Vec3& p) {
      return p + Vec3{0.11, 0.07, high.z - low.z + 0.015};
    }));
    c.stress_free = false;  // distances between bodies that are apart
    out.push_back(c);
  }
}

// Two bars on edge that cross at a quarter of an edge, or next to its end, where rows fade out.
void add_crossed_edges(std::vector<SceneCase>& out, Element element) {
  double place = 0.13, lean = 0;  // flanks of different slopes have no points as near to one as to the other
  const auto bar = [&](bool upper) {
    const CellType type = element == Element::tet10 ? CellType::tet10 : CellType::tet4;
    return mapped(box({2, 1, 1}, {1, 1, 1}, type), [&](const Vec3& p) {
      const double w = 0.3;
      const Vec3 ridge{p.x - 0.5, w * (p.y - p.z) + lean * (p.y + p.z - 2), w * (p.y + p.z - 2)};
      return upper ? Vec3{ridge.y + place, ridge.x + place, -ridge.z + 0.015} : ridge;
    });
  };
  for (const double friction : {0.0, 0.4}) {
    SurfaceContactDef def;
    def.against = static_cast<BodyId>(1);
    def.friction = friction;
    def.thickness = 0.02;
    def.initial_overlap = InitialOverlap::resolve;
    SceneCase c =
        on_block(friction > 0 ? "crossed edges with friction" : "crossed edges", element,
                 {"constraints/edge_contact", "constraints/edge_contact_pool", "constraints/edge_geometry",
                  "constraints/edge_distance", "constraints/surface_edges"},
                 surface_contact(def));
    c.mesh = bar(false);
    c.more_bodies = {bar(true)};
    c.stress_free = false;  // distances between bodies that are apart
    out.push_back(c);
    if (friction == 0) continue;
    def.coupling = FrictionCoupling::coupled;
    c.name += ", coupled";
    c.covers = {"constraints/edge_touch"};
    c.effects.back() = surface_contact(def);
    out.push_back(c);
    def.friction = 0.003;
    place = 0.05;
    lean = 0.04;
    c.mesh = bar(false);
    c.name += ", slipping at the ends";
    c.more_bodies = {bar(true)};
    c.effects.back() = surface_contact(def);
    out.push_back(c);
  }
}

void add_rigid_bodies(std::vector<SceneCase>& out, Element element) {
  for (const auto shape : {ObstacleShape::sphere, ObstacleShape::capsule, ObstacleShape::cylinder,
                           ObstacleShape::box, ObstacleShape::mesh, ObstacleShape::distance_field}) {
    RigidBodyDef thing;
    thing.name = "thing";
    thing.shape.shape = shape;
    thing.shape.position = {0.3, 0.2, 1.9};
    thing.shape.axis = {0.3, 0.1, 1};
    thing.shape.radius = 0.4;
    thing.shape.length = 0.7;
    thing.shape.size = {0.9, 0.7, 0.5};
    if (shape == ObstacleShape::box) thing.shape.rounding = 0.05;
    if (is_solid(shape)) thing.shape.solid = step_solid(shape, 0.8);
    ContactDef touch;
    touch.against = "thing";
    touch.friction = 0.3;
    touch.coupling = FrictionCoupling::coupled;
    SceneCase c =
        on_block("contact with a rigid body, shape " + std::to_string(static_cast<int>(shape)), element,
                 {"constraints/contact", "constraints/contact_frame", "constraints/rigid_body",
                  "constraints/moved_solid", "constraints/contact_impact"},
                 rigid_body(thing));
    c.effects.push_back(contact(touch));
    c.stress_free = false;  // distances between bodies that are apart
    out.push_back(c);
    ContactDef floor;
    floor.rigid = "thing";
    floor.obstacle.position = {0, 0, -3};
    floor.obstacle.axis = {0.1, 0.2, 1};
    floor.friction = 0.4;
    floor.restitution = 0.5;
    floor.coupling = FrictionCoupling::coupled;
    c.name = "rigid body on a floor, shape " + std::to_string(static_cast<int>(shape));
    c.effects.back() = contact(floor);
    c.rigid_invariant = false;
    out.push_back(c);
  }
}

}  // namespace

void add_attachments(std::vector<SceneCase>& out) {
  for (const Element element : {Element::tet4, Element::tet10}) {
    add_held(out, element);
    add_threads(out, element);
    add_chambers(out, element);
    add_contacts(out, element);
    add_surface_contacts(out, element);
    add_crossed_edges(out, element);
    if (element == Element::tet4) add_rigid_bodies(out, element);
  }
}

}  // namespace test
