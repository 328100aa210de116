// Bodies that meet obstacles.
#include <cmath>

#include "scenes/programs/parts.h"

namespace isochor {

using namespace programs;

namespace {

ContactDef against(const char* name, ObstacleShape shape, const Vec3& position) {
  ContactDef c;
  c.name = name;
  c.obstacle.shape = shape;
  c.obstacle.position = position;
  return c;
}

MetricDef of_contact(const char* name, Quantity quantity, const char* contact, const char* unit,
                     Component component = Component::magnitude) {
  MetricDef m;
  m.name = name;
  m.quantity = quantity;
  m.of = contact;
  m.component = component;
  m.unit = unit;
  return m;
}

}  // namespace

SceneDef ball_drop(const SceneVariant& v) {
  SceneDef s = on_mesh("ball_drop", "Ball dropped on the floor",
                       "A soft incompressible ball of 10 cm falls by 10 cm onto a floor and bounces.", "ball",
                       "ball", v);
  s.bodies[0].materials = {rubber(1e5, 0.5)};
  s.analysis.options.gravity = {0, 0, -9.81};
  s.contacts = {against("floor", ObstacleShape::plane, {0, 0, -0.15})};
  s.analysis.type = AnalysisType::dynamics;
  s.analysis.duration = 0.3;
  s.analysis.step = 0.005;
  s.probes = {{"center", {}, {0, 0, 0}}, {"bottom", {}, {0, 0, -0.05}}};
  s.outputs.every = 5;
  MetricDef fall = displacement("center just above the floor", "center", Component::z);
  fall.time = 0.135;
  s.metrics = {programs::against(fall, -0.5 * 9.81 * 0.135 * 0.14, 1e-3,
                                 "free fall in steps of implicit Euler, g t (t + h) / 2"),
               at_time(displacement("center at its lowest", "center", Component::z), 0.165),
               at_time(displacement("center on its way up", "center", Component::z), 0.22),
               of_contact("gap", Quantity::contact_gap, "floor", "m")};
  keep_volume(s);
  return s;
}

SceneDef incline(const SceneVariant& v) {
  SceneDef s;
  s.name = "incline";
  s.title = "Block that slides down a slope";
  s.description = "A flat block on a slope of 30 degrees with a coefficient of friction of 0.3: it slides.";
  SceneBody b;
  b.name = "block";
  b.mesh = BoxMeshDef{{-0.1, -0.05, 0}, {0.1, 0.05, 0.04}, {8, 4, 3}, CellType::tet4};
  b.element = v.element.value_or(Element::tet4_edge_smoothed);
  b.materials = {rubber(1e5, 0.49)};
  s.bodies = {b};
  // Down the slope is x, and gravity leans.
  const double slope = std::acos(-1.0) / 6, friction = 0.3;
  s.analysis.options.gravity = {9.81 * std::sin(slope), 0, -9.81 * std::cos(slope)};
  ContactDef floor = against("slope", ObstacleShape::plane, {});
  floor.surfaces = {"z0"};
  floor.friction = friction;
  s.contacts = {floor};
  s.analysis.type = AnalysisType::dynamics;
  s.analysis.duration = 0.5;
  s.analysis.step = 0.005;
  s.probes = {{"middle", {}, {0, 0, 0.02}}};
  s.outputs.every = 10;
  const double a = 9.81 * (std::sin(slope) - friction * std::cos(slope));
  s.metrics = {
      programs::against(displacement("slid", "middle", Component::x), 0.5 * a * 0.5 * 0.505, 0.01,
                        "a t (t + h) / 2, a = g (sin - mu cos): Coulomb, in steps of implicit Euler"),
      programs::against(of_contact("push of the slope", Quantity::contact_force, "slope", "N", Component::z),
                        0.8 * 9.81 * std::cos(slope), 0.01, "weight across the slope")};
  return s;
}

SceneDef squeezed_block(const SceneVariant& v) {
  SceneDef s;
  s.name = "squeezed_block";
  s.title = "Block pressed between cylinders and released";
  s.description =
      "Two rigid cylinders close on an elastic block from above and below, hold it and let it go again.";
  SceneBody b;
  b.name = "block";
  b.mesh = BoxMeshDef{{-0.1, -0.05, -0.05}, {0.1, 0.05, 0.05}, {8, 4, 4}, CellType::tet4};
  b.element = v.element.value_or(Element::tet4_edge_smoothed);
  b.materials = {rubber(1e5, 0.5)};
  s.bodies = {b};
  for (const double side : {-1.0, 1.0}) {
    ContactDef c = against(side < 0 ? "lower" : "upper", ObstacleShape::capsule, {0, 0, side * 0.072});
    c.obstacle.axis = {0, 1, 0};
    c.obstacle.radius = 0.02;
    c.obstacle.length = 0.2;
    c.friction = 0.3;
    const double travel[] = {0, 0.032, 0.032, -0.05};
    const double when[] = {0, 0.4, 0.6, 0.9};
    for (int k = 0; k < 4; ++k) {
      Pose p;
      p.t = when[k];
      p.position.z = -side * travel[k];
      c.obstacle.motion.keys.push_back(p);
    }
    s.contacts.push_back(c);
  }
  s.analysis.type = AnalysisType::dynamics;
  s.analysis.duration = 1.2;
  s.analysis.step = 0.02;
  s.probes = {{"end", {}, {0.1, 0, 0}}, {"top", {}, {0, 0, 0.05}}};
  s.outputs.every = 5;
  s.metrics = {
      at_time(of_contact("push when closed", Quantity::contact_force, "upper", "N", Component::z), 0.6),
      at_time(displacement("bulge at the end", "end", Component::x), 0.6),
      programs::against(of_contact("push when released", Quantity::contact_force, "upper", "N"), 0, 0,
                        "contact does not pull"),
      displacement("top at the end", "top", Component::z)};
  keep_volume(s);
  return s;
}

namespace {

// One of three fingers around the ball: hangs, is inflated until `closed` and lifted until `up`.
void add_gripper_finger(SceneDef& s, int k, double closed, double up, const SceneVariant& v) {
  const double third = 2 * std::acos(-1.0) / 3;
  const std::string name = "finger " + std::to_string(k + 1);
  // From along x with the sole below to hanging down with the sole inward, then around the axis.
  const double a = 0.5 * third, phi = k * third, c = std::cos(0.5 * phi), n = std::sin(0.5 * phi);
  const double w0 = std::cos(a), q = std::sin(a) / std::sqrt(3.0);
  const double w = c * w0 + n * q;
  const Vec3 u{c * q - n * q, c * q + n * q, -c * q + n * w0};
  const double sine = std::sqrt(dot(u, u));
  SceneBody b;
  b.name = name;
  MeshFile mesh{"meshes/finger_small.msh", 1};
  // Without the last digits, which depend on how this is compiled.
  const auto tidy = [](Vec3 x) {
    for (int i = 0; i < 3; ++i) x[i] = std::round(1e12 * x[i]) / 1e12;
    return x;
  };
  mesh.turn = tidy((2 * std::atan2(sine, w) / sine) * u);
  mesh.offset = tidy({0.032 * std::cos(phi), 0.032 * std::sin(phi), 0});
  b.mesh = mesh;
  b.element = v.element.value_or(Element::tet4_edge_smoothed);
  b.materials = {rubber(100e3, 0.499, 1000, "body"), rubber(3e6, 0.499, 1000, "limiting_layer")};
  s.bodies.push_back(b);
  const BodyId body{k};
  DirichletDef base = hold("", "clamped");
  base.name = "base " + std::to_string(k + 1);
  base.where.body = body;
  base.displacement = {0, 0, 0.04};
  base.amount = Curve{{{closed + 0.2, 0}, {up, 1}}};
  s.dirichlet.push_back(base);
  CavityDef air = chamber("chamber", 0);
  air.name = "air " + std::to_string(k + 1);
  air.body = body;
  air.amount = Curve{{{0, 0}, {closed, 14e3}}};
  s.cavities.push_back(air);
  ContactDef grip;
  grip.name = "grip " + std::to_string(k + 1);
  grip.body = body;
  grip.surfaces = {"outer", "tip"};
  grip.against = "ball";
  grip.friction = 0.8;
  s.contacts.push_back(grip);
}

}  // namespace

SceneDef gripper(const SceneVariant& v) {
  SceneDef s;
  s.name = "gripper";
  s.title = "Soft gripper";
  s.description =
      "Three pneumatic fingers hang around a free rigid ball on a table, are inflated until they grip it, "
      "lift it by "
      "4 cm and hold it by friction for five seconds.";
  s.folder = scenes_folder();
  const double ball = 0.025, height = -0.052, closed = 0.8, up = 2;
  for (int k = 0; k < 3; ++k) add_gripper_finger(s, k, closed, up, v);
  RigidBodyDef thing;
  thing.name = "ball";
  thing.shape.shape = ObstacleShape::sphere;
  thing.shape.radius = ball;
  thing.shape.position = {0, 0, height};
  thing.density = 100;
  s.rigid_bodies = {thing};
  ContactDef table = against("table", ObstacleShape::plane, {0, 0, height - ball});
  table.rigid = "ball";
  table.friction = 0.5;
  s.contacts.push_back(table);
  s.analysis.options.gravity = {0, 0, -9.81};
  s.analysis.type = AnalysisType::dynamics;
  s.analysis.duration = up + 5.2;
  s.analysis.step = 0.04;
  s.outputs.every = 5;
  MetricDef lifted;
  lifted.name = "ball when lifted";
  lifted.quantity = Quantity::rigid_z;
  lifted.of = "ball";
  lifted.unit = "m";
  MetricDef held = lifted;
  held.name = "ball after five seconds";
  held = programs::against(held, height + 0.04, 0.1,
                           "it is to stay up, within a tenth of where it was lifted to");
  lifted.time = up + 0.2;
  s.metrics = {lifted, held};
  keep_volume(s);
  return s;
}

SceneDef indented_puck(const SceneVariant& v) {
  SceneDef s =
      on_mesh("indented_puck", "Puck indented by a sphere",
              "A rigid sphere of 20 mm is pressed 5 mm into an incompressible puck that is bonded to "
              "its base.",
              "puck", "indented_puck", v);
  s.bodies[0].materials = {rubber(5e4, 0.5)};
  s.dirichlet = {hold("base", "bottom")};
  ContactDef c = against("sphere", ObstacleShape::sphere, {0, 0, 0.045});
  c.surfaces = {"top"};
  c.obstacle.radius = 0.02;
  c.obstacle.motion.keys.resize(2);
  c.obstacle.motion.keys[1].t = 1;
  c.obstacle.motion.keys[1].position.z = -0.005;
  s.contacts = {c};
  s.analysis.steps = 5;
  s.probes = {{"middle", {}, {0, 0, 0.025}}};
  s.metrics = {of_contact("push of the sphere", Quantity::contact_force, "sphere", "N", Component::z),
               of_contact("contact area", Quantity::contact_area, "sphere", "m^2"),
               of_contact("largest pressure", Quantity::contact_pressure, "sphere", "Pa"),
               displacement("middle", "middle", Component::z)};
  keep_volume(s);
  return s;
}

SceneDef bellows(const SceneVariant& v) {
  SceneDef s =
      on_mesh("bellows", "Bellows that folds onto itself",
              "Air is drawn out of a bellows until its folds lie on each other.", "bellows", "bellows", v);
  s.bodies[0].materials = {rubber(1e5, 0.5)};
  s.dirichlet = {hold("base", "clamped")};
  CavityDef air = chamber("chamber", 0);
  air.control = CavityControl::volume_ratio;
  air.amount = Curve{{{0, 1}, {1, 0.25}}};
  s.cavities = {air};
  SurfaceContactDef folds;
  folds.name = "folds";
  s.surface_contacts = {folds};
  s.analysis.steps = 15;
  s.probes = {{"top", {}, {0, 0.069, 0}}};
  MetricDef suction;
  suction.name = "pressure";
  suction.quantity = Quantity::cavity_pressure;
  suction.of = "chamber";
  suction.unit = "Pa";
  s.metrics = {displacement("stroke", "top", Component::y), suction,
               of_contact("contact area", Quantity::contact_area, "folds", "m^2"),
               of_contact("gap", Quantity::contact_gap, "folds", "m")};
  keep_volume(s);
  return s;
}

SceneDef colliding_balls(const SceneVariant& v) {
  SceneDef s =
      on_mesh("colliding_balls", "Two balls that collide",
              "Two soft incompressible balls of 10 cm meet off center at 4 m/s, in free space, and part.",
              "left", "ball_small", v);
  s.bodies[0].materials = {rubber(1e5, 0.5)};
  s.bodies[0].velocity = {2, 0, 0};
  s.bodies.push_back(s.bodies[0]);
  s.bodies[1].name = "right";
  s.bodies[1].velocity = {-2, 0, 0};
  auto& mesh = std::get<MeshFile>(s.bodies[1].mesh);
  mesh.offset = {0.11, 0.03, 0};
  SurfaceContactDef meet;
  meet.name = "meet";
  meet.against = BodyId{1};
  meet.friction = 0.3;
  s.surface_contacts = {meet};
  s.analysis.type = AnalysisType::dynamics;
  s.analysis.scheme = SchemeWord::bdf2;
  s.analysis.duration = 0.1;
  s.analysis.step = 0.001;
  s.outputs.every = 2;
  s.probes = {{"middle of the left", BodyId{0}, {0, 0, 0}},
              {"middle of the right", BodyId{1}, {0.11, 0.03, 0}}};
  s.metrics = {at_time(of_contact("push when closest", Quantity::contact_force, "meet", "N"), 0.03),
               displacement("left at the end", "middle of the left", Component::x),
               displacement("right at the end", "middle of the right", Component::x)};
  keep_volume(s);
  return s;
}

}  // namespace isochor
