// Coulomb friction: derivatives of its potential, angles at which blocks slide, how fast, and what is
// carried.
#include <array>
#include <cmath>
#include <random>

#include "constraints/contact/rigid/contact_pool.h"
#include "isochor/contact.h"
#include "support/worlds.h"

namespace {

using namespace isochor;

double gauge_of(const World& world, const std::string& quantity) {
  for (const Gauge& g : world.gauges()) {
    if (g.kind == "contact" && g.quantity == quantity) return g.value;
  }
  FAIL("no gauge " << quantity);
  return 0;
}

constexpr double kDegree = 0.017453292519943295;

struct Incline {
  World world;
  BodyId body{};
  Vec3 down{};  // along the slope
  double along() const {
    Vec3 center{};
    const auto x = world.positions(body), rest = world.rest_positions(body);
    for (std::size_t i = 0; i < x.size(); ++i)
      center += (1 / static_cast<double>(x.size())) * (x[i] - rest[i]);
    return dot(center, down);
  }
};

// A flat block on a slope, at rest when gravity begins.
Incline incline(double degrees, double friction, bool statics = false, double static_friction = 0) {
  const double c = std::cos(degrees * kDegree), s = std::sin(degrees * kDegree);
  WorldOptions options = statics ? test::static_options() : test::dynamic_options();
  options.gravity = {0, 0, -9.81};
  if (static_friction > 0) options.gravity_curve = Curve::ramp(1, 0.2);  // what bounces at first would slip
  Incline i{test::make_world(options), {}, {c, 0, -s}};
  BoxMeshDef def;
  def.lower = {-0.1, -0.05, 0};
  def.upper = {0.1, 0.05, 0.04};
  def.divisions = {6, 3, 2};
  const Mesh mesh = test::mapped(test::value(box_mesh(def)), [&](const Vec3& p) {
    return Vec3{c * p.x + s * p.z, p.y, -s * p.x + c * p.z};
  });
  i.body = test::add_body(i.world, mesh, Element::tet4_edge_smoothed, test::neo_hookean(1e5, 0.49));
  test::add_volume(i.world, i.body);
  ContactDef contact_def;
  contact_def.body = i.body;
  contact_def.surfaces = {"z0"};
  contact_def.obstacle.axis = {s, 0, c};
  contact_def.friction = friction;
  contact_def.static_friction = static_friction;
  test::value(i.world.add(contact(contact_def)));
  return i;
}

}  // namespace

TEST_CASE("the potential of friction has exact derivatives, sticking and slipping") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto any = [&] { return Vec3{unit(random), unit(random), unit(random)}; };
  Obstacle ball;
  ball.shape = ObstacleShape::sphere;
  ball.radius = 0.7;
  ball.motion.keys = std::vector<Pose>(2);
  ball.motion.keys[1] = {1, {0.2, 0.1, 0}, {0.8, 0, 0.6, 0}};
  int stuck = 0, slipped = 0;
  for (int k = 0; k < 200; ++k) {
    RigidGeometry geometry(ball);
    geometry.add(0, 3.0);
    const ContactPool pool("probe", geometry, 0.5, false);
    const std::array<Vec3, 1> before{Vec3{0.9, 0.3, 0.4} + 0.2 * any()}, lag{before[0] + 0.2 * any()};
    std::array<Vec3, 1> x{before[0] + 0.3 * any()};
    const std::array<double, 1> multiplier{-0.7}, held{-1.5 + unit(random)};
    const std::array<double, 3> memory{0.2 * unit(random), 0.2 * unit(random), 0.2 * unit(random)};
    std::array<double, 1> energy{}, value{};
    std::array<Vec3, 1> gradient{}, jacobian{};
    std::array<Mat3, 1> hessian{};
    const auto evaluate = [&](const Vec3& at) {
      x[0] = at;
      StencilRequest q;
      q.want = Want::hessian;
      q.end = 1;
      q.x = x;
      q.rest = before;
      q.function_multiplier = multiplier;
      q.increment = {0.1, before, 0.2, 0.4};
      q.lag = {lag, held};
      q.memory = memory;
      pool.evaluate(q, {energy, value, gradient, jacobian, hessian});
    };
    const Vec3 middle = x[0], d = any();
    const double h = 1e-6;
    evaluate(middle + h * d);
    const double up = energy[0] + multiplier[0] * value[0];
    const Vec3 g_up = gradient[0];
    const Mat3 h_up = hessian[0];
    evaluate(middle - h * d);
    const double down = energy[0] + multiplier[0] * value[0];
    const Vec3 g_down = gradient[0];
    double jump = 0;
    for (std::size_t i = 0; i < 9; ++i) jump += std::abs(h_up.m[i] - hessian[0].m[i]);
    evaluate(middle);
    CHECK((up - down) / (2 * h) == Approx(dot(gradient[0], d)).margin(1e-8));
    if (jump > 1e-2) continue;  // between sticking and slipping the slope of the force jumps
    const Vec3 error = (1 / (2 * h)) * (g_up - g_down) - hessian[0] * d;
    CHECK(dot(error, error) < 1e-14);
    const Vec3 friction = gradient[0] - multiplier[0] * jacobian[0];
    const double limit = -0.5 * held[0], force = std::sqrt(dot(friction, friction));
    CHECK(force <= limit * (1 + 1e-12));
    (force < limit * (1 - 1e-9) ? stuck : slipped) += 1;
  }
  CHECK(stuck > 20);
  CHECK(slipped > 20);
}

TEST_CASE("a block on a slope sticks below the angle of friction and slides above it") {
  for (const double friction : {0.1, 0.5, 1.0}) {
    const double limit = std::atan(friction) / kDegree;
    for (const double beyond : {-0.5, 0.5}) {
      INFO("friction " << friction << ", slope " << limit + beyond << " degrees");
      Incline i = incline(limit + beyond, friction);
      double at_half = 0;
      int iterations = 0;
      for (int k = 0; k < 100; ++k) {
        iterations += test::must_advance(i.world, 0.01).iterations;
        if (k == 49) at_half = i.along();
      }
      const double slope = (limit + beyond) * kDegree;
      CHECK(iterations < 300);
      if (beyond < 0) {
        CHECK(std::abs(i.along() - at_half) < 1e-9);
        CHECK(i.along() < 1e-3);
      } else {
        const double a = 9.81 * (std::sin(slope) - friction * std::cos(slope));
        CHECK(i.along() > 0.5 * 0.5 * a);
      }
    }
  }
}

TEST_CASE("a sliding block accelerates as Coulomb says") {
  for (const double friction : {0.0, 0.3}) {
    const double slope = 30 * kDegree, h = 0.005;
    INFO("friction " << friction);
    Incline i = incline(30, friction);
    double velocity[2];
    for (int k = 0; k < 2; ++k) {
      double before = 0;
      for (int s = 0; s < 60; ++s) {
        before = i.along();
        test::must_advance(i.world, h);
      }
      velocity[k] = (i.along() - before) / h;
    }
    const double a = (velocity[1] - velocity[0]) / (60 * h);
    CHECK(a == Approx(9.81 * (std::sin(slope) - friction * std::cos(slope))).epsilon(0.01));
    const double normal = gauge_of(i.world, "normal_force");
    CHECK(normal == Approx(0.2 * 0.1 * 0.04 * 1000 * 9.81 * std::cos(slope)).epsilon(0.01));
    CHECK(gauge_of(i.world, "friction_force") == Approx(friction * normal).epsilon(1e-6).margin(1e-12));
  }
}

TEST_CASE("what breaks away at the static coefficient slides with the kinetic one") {
  const double kinetic = 0.3, breakaway = 0.8, h = 0.005;
  const auto run = [&](Incline& i) {
    for (int k = 0; k < 40; ++k) test::must_advance(i.world, h);
  };
  const auto acceleration = [&](Incline& i) {
    double velocity[2];
    for (double& v : velocity) {
      double before = 0;
      for (int s = 0; s < 40; ++s) {
        before = i.along();
        test::must_advance(i.world, h);
      }
      v = (i.along() - before) / h;
    }
    return (velocity[1] - velocity[0]) / (40 * h);
  };
  const auto sliding = [&](double degrees) {
    return 9.81 * (std::sin(degrees * kDegree) - kinetic * std::cos(degrees * kDegree));
  };
  // tan 39 > 0.8: it breaks away.
  Incline above = incline(39, kinetic, false, breakaway);
  run(above);
  CHECK(acceleration(above) == Approx(sliding(39)).epsilon(0.01));
  // tan 18.5 = 0.33: it holds, though the kinetic coefficient alone would not. (Nearer to the limit edges
  // that break away, as they stick unevenly, take the rest with them.)
  Incline below = incline(18.5, kinetic, false, breakaway);
  run(below);
  CHECK(std::abs(acceleration(below)) < 1e-4);
  CHECK(below.along() < 1e-3);
  // Unless it slides already, also after a checkpoint.
  const std::vector<Vec3> v(below.world.positions(below.body).size(), below.down);
  REQUIRE(below.world.set_velocities(below.body, v));
  run(below);
  CHECK(acceleration(below) == Approx(sliding(18.5)).epsilon(0.01));
  Incline again = incline(18.5, kinetic, false, breakaway);
  REQUIRE(again.world.load(below.world.save()));
  CHECK(acceleration(again) == Approx(sliding(18.5)).epsilon(0.01));
}

TEST_CASE("very high friction holds a block on a steep slope") {
  Incline i = incline(70, 1000);
  for (int k = 0; k < 50; ++k) test::must_advance(i.world, 0.01);
  CHECK(i.along() < 2e-3);
  CHECK(gauge_of(i.world, "contact_area") > 0);
}

TEST_CASE("statics: friction carries a push up to its limit, the rest goes on") {
  // Light springs hold the block where friction does not.
  const double weight = 0.2 * 0.1 * 0.04 * 1000 * 9.81, friction = 0.5;
  WorldOptions options = test::static_options();
  options.gravity = {0, 0, -9.81};
  World world = test::make_world(options);
  BoxMeshDef def;
  def.upper = {0.2, 0.1, 0.04};
  def.divisions = {5, 3, 2};
  const BodyId body = test::add_body(world, test::value(box_mesh(def)), Element::tet4_edge_smoothed,
                                     test::neo_hookean(1e5, 0.45));
  DirichletDef springs;
  springs.where.body = body;
  springs.where.everything = true;
  springs.directions = {{1, 0, 0}, {0, 1, 0}};
  springs.treatment = SupportTreatment::stiffness;
  springs.stiffness = 20;
  test::value(world.add(dirichlet(springs)));
  PointForceDef push;
  push.where.body = body;
  push.where.everything = true;
  push.force = {1, 0, 0};
  push.amount = Curve{{{1, 0}, {2, 0.9 * friction * weight}, {3, 1.5 * friction * weight}}};
  test::value(world.add(point_force(push)));
  ContactDef floor;
  floor.body = body;
  floor.surfaces = {"z0"};
  floor.friction = friction;
  test::value(world.add(contact(floor)));
  test::must_advance(world);
  CHECK(gauge_of(world, "normal_force") == Approx(weight).epsilon(1e-6));
  const double at_rest = gauge_of(world, "force_x");
  CHECK(std::abs(at_rest) < 1e-3 * weight);
  test::must_advance(world);
  CHECK(gauge_of(world, "force_x") == Approx(-0.9 * friction * weight).epsilon(0.02));
  const double stuck = test::displacement_at(world, body, {0.1, 0.05, 0}).x;
  CHECK(stuck < 2e-3);
  test::must_advance(world);
  CHECK(gauge_of(world, "force_x") == Approx(-friction * weight).epsilon(0.02));
  // The fields say the same node by node.
  const BodyFields fields = world.fields(body);
  std::size_t pressed = 0;
  for (std::size_t i = 0; i < fields.node_contact_pressure.size(); ++i) {
    if (!(fields.node_contact_pressure[i] > 1)) continue;
    ++pressed;
    CHECK(fields.node_friction[3 * i] == Approx(-friction * fields.node_contact_pressure[i]).epsilon(0.02));
    CHECK(std::abs(fields.node_friction[3 * i + 2]) < 1e-9 * fields.node_contact_pressure[i]);
  }
  CHECK(pressed > 10);
  const double slid = test::displacement_at(world, body, {0.1, 0.05, 0.04}).x;
  CHECK(slid == Approx(0.5 * friction * weight / 20).epsilon(0.05));
}

TEST_CASE("a block is carried by a moving floor until it cannot follow") {
  for (const double acceleration : {2.0, 8.0}) {
    const double friction = 0.5, h = 0.01;
    INFO("acceleration " << acceleration);
    WorldOptions options = test::dynamic_options();
    options.gravity = {0, 0, -9.81};
    World world = test::make_world(options);
    BoxMeshDef def;
    def.lower = {-0.1, -0.05, 0};
    def.upper = {0.1, 0.05, 0.04};
    def.divisions = {5, 3, 2};
    const BodyId body = test::add_body(world, test::value(box_mesh(def)), Element::tet4_edge_smoothed,
                                       test::neo_hookean(1e5, 0.45));
    ContactDef contact_def;
    contact_def.body = body;
    contact_def.surfaces = {"z0"};
    contact_def.friction = friction;
    std::vector<Pose> keys(61);
    for (int k = 0; k <= 60; ++k) {
      const double t = k * h, moving = std::max(0.0, t - 0.1);
      Pose pose;
      pose.t = t;
      pose.position.y = 0.5 * acceleration * moving * moving;
      keys[static_cast<std::size_t>(k)] = pose;
    }
    contact_def.obstacle.motion.keys = std::move(keys);
    test::value(world.add(contact(contact_def)));
    for (int k = 0; k < 60; ++k) test::must_advance(world, h);
    const double moved = test::displacement_at(world, body, {0, 0, 0}).y;
    const double floor = 0.5 * acceleration * 0.25;
    if (acceleration < friction * 9.81) {
      CHECK(moved == Approx(floor).epsilon(0.02));
    } else {
      CHECK(moved == Approx(0.5 * friction * 9.81 * 0.25).epsilon(0.04));
    }
  }
}
