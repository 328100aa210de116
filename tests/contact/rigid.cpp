// Free rigid bodies: they fall, spin and roll as mechanics says, and soft bodies push and carry them.
#include <cmath>

#include "isochor/contact.h"
#include "support/worlds.h"

namespace {

using namespace isochor;

double gauge_of(const World& world, const std::string& effect, const std::string& quantity) {
  for (const Gauge& g : world.gauges()) {
    if (g.effect == effect && g.quantity == quantity) return g.value;
  }
  FAIL("no gauge " << effect << ", " << quantity);
  return 0;
}

// A scene needs a soft body: a small held block, far away unless it is put to use.
BodyId add_block(World& world, const Vec3& lower, const Vec3& upper, std::array<int, 3> divisions,
                 bool held = true) {
  BoxMeshDef def;
  def.lower = lower;
  def.upper = upper;
  def.divisions = divisions;
  const BodyId body = test::add_body(world, test::value(box_mesh(def)), Element::tet4_edge_smoothed,
                                     test::neo_hookean(5e4, 0.49));
  test::add_volume(world, body);
  if (held) test::hold(world, body, {"z0"});
  return body;
}

World with_gravity(const Vec3& g) {
  WorldOptions options = test::dynamic_options();
  options.gravity = g;
  return test::make_world(options);
}

void add_rigid(World& world, ObstacleShape shape, const Vec3& position) {
  RigidBodyDef def;
  def.name = "thing";
  def.shape.shape = shape;
  def.shape.position = position;
  def.shape.radius = 0.05;
  def.shape.length = 0.2;
  def.shape.size = {0.1, 0.2, 0.06};
  test::value(world.add(rigid_body(def)));
}

}  // namespace

TEST_CASE("free rigid bodies of every shape fall freely") {
  for (const auto shape :
       {ObstacleShape::sphere, ObstacleShape::capsule, ObstacleShape::cylinder, ObstacleShape::box}) {
    World world = with_gravity({0, 0, -9.81});
    add_block(world, {2, 0, 0}, {2.1, 0.1, 0.1}, {1, 1, 1});
    add_rigid(world, shape, {0, 0, 1});
    const double h = 0.01;
    for (int k = 0; k < 20; ++k) test::must_advance(world, h);
    CHECK(gauge_of(world, "thing", "z") == Approx(1 - 0.5 * 9.81 * 0.2 * 0.21).epsilon(1e-10));
    CHECK(gauge_of(world, "thing", "turn") < 1e-6);
  }
}

TEST_CASE("a rigid ball rolls down a slope with five sevenths of gravity's pull") {
  for (const double friction : {0.0, 0.5}) {
    INFO("friction " << friction);
    const double slope = 0.3, h = 0.005;
    World world = with_gravity({9.81 * std::sin(slope), 0, -9.81 * std::cos(slope)});
    add_block(world, {0, 1, 0}, {0.1, 1.1, 0.1}, {1, 1, 1});
    add_rigid(world, ObstacleShape::sphere, {0, 0, 0.05});
    ContactDef floor;
    floor.name = "floor";
    floor.rigid = "thing";
    floor.friction = friction;
    test::value(world.add(contact(floor)));
    for (int k = 0; k < 60; ++k) test::must_advance(world, h);
    const double a = 9.81 * std::sin(slope) * (friction > 0 ? 5.0 / 7 : 1.0), t = 0.3;
    const double rolled = 0.5 * a * t * (t + h);
    CHECK(gauge_of(world, "thing", "x") == Approx(rolled).epsilon(0.01));
    CHECK(gauge_of(world, "thing", "z") == Approx(0.05).epsilon(1e-9));
    CHECK(
        gauge_of(world, "floor", "normal_force") ==
        Approx(4.0 / 3 * std::acos(-1.0) * 0.05 * 0.05 * 0.05 * 1000 * 9.81 * std::cos(slope)).epsilon(1e-6));
    if (friction > 0) {
      CHECK(gauge_of(world, "thing", "turn") == Approx(rolled / 0.05).epsilon(0.02));
    } else {
      CHECK(gauge_of(world, "thing", "turn") < 1e-6);
    }
  }
}

TEST_CASE("a rigid box comes to rest on its face and stays") {
  World world = with_gravity({0, 0, -9.81});
  add_block(world, {2, 0, 0}, {2.1, 0.1, 0.1}, {1, 1, 1});
  add_rigid(world, ObstacleShape::box, {0, 0, 0.05});
  ContactDef floor;
  floor.name = "floor";
  floor.rigid = "thing";
  floor.friction = 0.4;
  test::value(world.add(contact(floor)));
  for (int k = 0; k < 40; ++k) test::must_advance(world, 0.01);
  CHECK(gauge_of(world, "thing", "z") == Approx(0.03).epsilon(1e-9));
  CHECK(gauge_of(world, "thing", "speed") < 1e-6);
  CHECK(gauge_of(world, "floor", "normal_force") == Approx(1.2 * 9.81).epsilon(1e-6));
}

TEST_CASE("a soft block carries a rigid ball, action and reaction alike") {
  World world = with_gravity({0, 0, -9.81});
  const BodyId body = add_block(world, {-0.1, -0.1, 0}, {0.1, 0.1, 0.1}, {4, 4, 2});
  add_rigid(world, ObstacleShape::sphere, {0.004, 0.003, 0.151});
  ContactDef touch;
  touch.name = "touch";
  touch.body = body;
  touch.surfaces = {"z1"};
  touch.against = "thing";
  touch.friction = 0.5;
  test::value(world.add(contact(touch)));
  for (int k = 0; k < 60; ++k) test::must_advance(world, 0.01);
  const double weight = 4.0 / 3 * std::acos(-1.0) * 0.05 * 0.05 * 0.05 * 1000 * 9.81;
  CHECK(gauge_of(world, "touch", "force_z") == Approx(-weight).epsilon(1e-3));
  CHECK(gauge_of(world, "thing", "z") < 0.1501);
  CHECK(gauge_of(world, "thing", "z") > 0.13);
  CHECK(gauge_of(world, "touch", "smallest_gap") > -1e-9);
}

TEST_CASE("rigid bodies that cannot be are refused with their reason") {
  RigidBodyDef plane;
  plane.shape.shape = ObstacleShape::plane;
  World world = with_gravity({});
  CHECK(world.add(rigid_body(plane)).error() ==
        "rigid body \"rigid\": a plane has no end and no mass; take any other shape");
  World still = test::make_world(test::static_options());
  add_block(still, {0, 0, 0}, {1, 1, 1}, {1, 1, 1});
  add_rigid(still, ObstacleShape::sphere, {0, 0, 2});
  CHECK(still.compile().error().find("use a dynamic scheme") != std::string::npos);
  World nameless = with_gravity({});
  const BodyId body = add_block(nameless, {0, 0, 0}, {1, 1, 1}, {1, 1, 1});
  ContactDef touch;
  touch.body = body;
  touch.against = "nobody";
  test::value(nameless.add(contact(touch)));
  CHECK(nameless.compile().error() ==
        "contact \"contact\": there is no rigid body \"nobody\" yet; none was added before");
}
