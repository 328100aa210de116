// Newton's law of impact: heights of bounces, energy, and rest.
#include <cmath>

#include "engine/step/time_scheme.h"
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

// A rigid ball above a floor, beside a small soft body, which a scene needs.
World ball_above(double height, double restitution, SchemePtr scheme, double friction = 0,
                 const Vec3& gravity = {0, 0, -9.81}) {
  WorldOptions options = test::dynamic_options();
  options.scheme = std::move(scheme);
  options.gravity = gravity;
  World world = test::make_world(options);
  const BodyId body = test::add_body(world, test::block({2, 0, 0}, {2.1, 0.1, 0.1}, {1, 1, 1}), Element::tet4,
                                     test::neo_hookean(5e4, 0.3));
  test::hold(world, body, {"z0"});
  RigidBodyDef ball;
  ball.name = "ball";
  ball.shape.shape = ObstacleShape::sphere;
  ball.shape.radius = 0.05;
  ball.shape.position = {0, 0, 0.05 + height};
  test::value(world.add(rigid_body(ball)));
  ContactDef floor;
  floor.name = "floor";
  floor.rigid = "ball";
  floor.friction = friction;
  floor.restitution = restitution;
  test::value(world.add(contact(floor)));
  return world;
}

}  // namespace

TEST_CASE("a rigid ball bounces to the square of its restitution") {
  constexpr double height = 0.5, h = 5e-4;
  for (const SchemePtr& scheme : {implicit_euler(), bdf2(), generalized_alpha(0.8), newmark()}) {
    for (const double e : {0.5, 0.8, 1.0}) {
      INFO(scheme->name() << ", restitution " << e);
      World world = ball_above(height, e, scheme);
      double highest = 0, lowest = height, last = height;
      bool bounced = false;
      // Down, and up to the top of the first bounce.
      const double t = std::sqrt(2 * height / 9.81) * (1 + 1.1 * e) + 0.02;
      for (int k = 0; k * h < t; ++k) {
        test::must_advance(world, h);
        const double z = gauge_of(world, "ball", "z") - 0.05;
        lowest = std::min(lowest, z);
        bounced = bounced || z > last + 1e-9;
        if (bounced) highest = std::max(highest, z);
        last = z;
      }
      CHECK(lowest > -1e-9);
      CHECK(highest == Approx(e * e * height).epsilon(0.02).margin(2e-3));
      CHECK(highest < height);
    }
  }
}

TEST_CASE("a ball that bounces loses energy in every impact and comes to rest") {
  for (const bool euler : {true, false}) {
    INFO((euler ? "implicit Euler" : "BDF2"));
    World world = ball_above(0.1, 0.6, euler ? implicit_euler() : bdf2());
    double before = 9.81 * 0.1;
    for (int k = 0; k < 700; ++k) {
      test::must_advance(world, 2e-3);
      const double v = gauge_of(world, "ball", "speed");
      const double energy = 9.81 * (gauge_of(world, "ball", "z") - 0.05) + 0.5 * v * v;
      // What touches more slowly than restitution_speed follows the rules of the scheme alone.
      CHECK(energy <= before + (euler ? 1e-9 : 1e-3));
      before = energy;
    }
    CHECK(gauge_of(world, "ball", "z") == Approx(0.05).epsilon(1e-9));
    CHECK(gauge_of(world, "ball", "speed") < 1e-6);
  }
}

// A rigid box beside a soft body that is held throughout.
World box_above(double height, const Vec3& axis, double restitution, double friction = 0,
                const Vec3& gravity = {0, 0, -9.81}) {
  WorldOptions options = test::dynamic_options();
  options.gravity = gravity;
  World world = test::make_world(options);
  const BodyId body = test::add_body(world, test::block({2, 0, 0}, {2.1, 0.1, 0.1}, {1, 1, 1}), Element::tet4,
                                     test::neo_hookean(5e4, 0.3));
  test::hold(world, body, {"x0", "x1", "y0", "y1", "z0", "z1"});
  RigidBodyDef box;
  box.name = "box";
  box.shape.shape = ObstacleShape::box;
  box.shape.size = {0.2, 0.1, 0.06};
  box.shape.axis = axis;
  box.shape.position = {0, 0, height};
  test::value(world.add(rigid_body(box)));
  ContactDef floor;
  floor.name = "floor";
  floor.rigid = "box";
  floor.restitution = restitution;
  floor.friction = friction;
  test::value(world.add(contact(floor)));
  return world;
}

TEST_CASE("a rigid box that lands on a corner and tumbles never gains energy from its impacts") {
  for (const double e : {0.5, 1.0}) {
    INFO("restitution " << e);
    World world = box_above(0.4, {0.3, 0.2, 1}, e);
    double before = 1e9, highest = 0, last = 0.4;
    bool bounced = false;
    for (int k = 0; k < 1200; ++k) {
      test::must_advance(world, 5e-4);
      const double z = gauge_of(world, "box", "z");
      const double energy = world.kinetic_energy() + 1.2 * 9.81 * z;
      INFO("step " << k);
      CHECK(energy <= before + 1e-9);
      before = energy;
      bounced = bounced || z > last + 1e-7;
      if (bounced) highest = std::max(highest, z);
      last = z;
    }
    CHECK(highest > (e == 1 ? 0.15 : 0.07));
    CHECK(gauge_of(world, "floor", "smallest_gap") > -1e-9);
  }
}

TEST_CASE("what rests goes on resting, whatever its restitution") {
  World world = box_above(0.03, {0, 0, 1}, 0.9, 0.4, {1, 0, -9.81});
  for (int k = 0; k < 50; ++k) {
    test::must_advance(world, 0.01);
    CHECK(gauge_of(world, "box", "z") == Approx(0.03).epsilon(1e-9));
  }
  CHECK(gauge_of(world, "box", "speed") < 1e-5);
  CHECK(gauge_of(world, "floor", "normal_force") == Approx(1.2 * 9.81).epsilon(1e-6));
}

TEST_CASE("what a moving obstacle hits leaves it at its restitution") {
  // A floor that rises at 2 m/s under a ball at rest, without gravity.
  const double h = 1e-3, e = 0.5, speed = 2;
  WorldOptions options = test::dynamic_options();
  World world = test::make_world(options);
  const BodyId body = test::add_body(world, test::block({2, 0, 0}, {2.1, 0.1, 0.1}, {1, 1, 1}), Element::tet4,
                                     test::neo_hookean(5e4, 0.3));
  test::hold(world, body, {"z0"});
  RigidBodyDef ball;
  ball.name = "ball";
  ball.shape.shape = ObstacleShape::sphere;
  ball.shape.radius = 0.05;
  ball.shape.position = {0, 0, 0.1};
  test::value(world.add(rigid_body(ball)));
  ContactDef floor;
  floor.name = "floor";
  floor.rigid = "ball";
  floor.restitution = e;
  floor.obstacle.motion.keys = {{0, {0, 0, 0}, {1, 0, 0, 0}}, {1, {0, 0, speed}, {1, 0, 0, 0}}};
  test::value(world.add(contact(floor)));
  for (int k = 0; k < 60; ++k) test::must_advance(world, h);
  CHECK(gauge_of(world, "ball", "speed") == Approx((1 + e) * speed).epsilon(1e-6));
}

TEST_CASE("of a soft body each node bounces by itself, and no energy appears") {
  double upward[2] = {0, 0};  // fastest node soon after the impact [m/s]
  for (int k = 0; k < 2; ++k) {
    WorldOptions options = test::dynamic_options();
    World world = test::make_world(options);
    const BodyId body = test::add_body(world, test::block({0, 0, 0.02}, {0.1, 0.1, 0.12}, {3, 3, 3}),
                                       Element::tet4, test::neo_hookean(1e5, 0.45));
    test::add_volume(world, body);
    ContactDef floor;
    floor.body = body;
    floor.restitution = k;
    test::value(world.add(contact(floor)));
    const std::vector<Vec3> thrown(world.mesh(body).nodes.size(), Vec3{0, 0, -2});
    REQUIRE(world.set_velocities(body, thrown));
    double before = 1e9;
    for (int step = 0; step < 100; ++step) {
      test::must_advance(world, 1e-3);
      const double energy = world.kinetic_energy() + world.elastic_energy();
      INFO("restitution " << k << ", step " << step);
      CHECK(energy <= before + 1e-6);
      before = energy;
      if (step > 12) continue;
      for (const Vec3& v : world.velocities(body)) upward[k] = std::max(upward[k], v.z);
    }
    for (const Vec3& x : world.positions(body)) CHECK(x.z > -1e-9);
  }
  CHECK(upward[0] < 0.5);
  CHECK(upward[1] > 1);
}

TEST_CASE("restitution that cannot be is refused with the reason") {
  const auto refused = [](const auto& change, SchemePtr scheme) {
    WorldOptions options = test::dynamic_options();
    options.scheme = std::move(scheme);
    World world = test::make_world(options);
    const BodyId body = test::add_body(world, test::block({0, 0, 0}, {1, 1, 1}, {1, 1, 1}), Element::tet4,
                                       test::neo_hookean(1e5, 0.3));
    test::hold(world, body, {"z1"});
    ContactDef floor;
    floor.body = body;
    floor.restitution = 0.5;
    floor.obstacle.position.z = -1;
    change(floor);
    const auto added = world.add(contact(floor));
    if (!added) return added.error();
    const auto r = world.compile();
    return r ? std::string() : r.error();
  };
  const auto nothing = [](ContactDef&) {};
  CHECK(refused(nothing, implicit_euler()).empty());
  CHECK(refused([](ContactDef& c) { c.restitution = 1.2; }, implicit_euler()) ==
        "contact \"contact\": restitution = 1.2; it must be between 0 and 1, what more would add energy in "
        "every impact");
  CHECK(refused([](ContactDef& c) { c.restitution = -0.1; }, implicit_euler()).find("between 0 and 1") !=
        std::string::npos);
  CHECK(refused([](ContactDef& c) { c.restitution_speed = -1; }, implicit_euler()) ==
        "contact \"contact\": restitution_speed = -1 m/s; it must be zero or positive");
  CHECK(
      refused([](ContactDef& c) { c.compliance = 1e-6; }, implicit_euler()) ==
      "contact \"contact\": restitution = 0.5 with compliance = 1e-06 m/Pa; a soft layer bounces by its own "
      "elasticity: leave one of them 0");
  CHECK(refused(nothing, statics()) ==
        "world: \"contact\" makes velocities jump, and static has none; use a scheme of dynamics");
  CHECK(refused(nothing, implicit_midpoint()) ==
        "world: \"contact\" makes velocities jump, which implicit_midpoint spreads over the middles of two "
        "steps; use another scheme");
}
