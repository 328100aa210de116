// Time schemes against a motion whose solution is known, and what they keep.
#include <cmath>
#include <functional>
#include <string>

#include "support/worlds.h"

namespace {

using namespace isochor;

void must_step(World& world, double h) {
  const StepReport report = world.step(h);
  INFO(report.reason);
  REQUIRE(report.status == StepStatus::converged);
}

constexpr double kPi = 3.14159265358979323846;

// Free fall: exact for what a scheme should integrate exactly, and the period of a stretched bar otherwise.
struct Named {
  const char* name;
  std::function<SchemePtr()> make;
  int order;
};
const Named kSchemes[] = {{"implicit_euler", [] { return implicit_euler(); }, 1},
                          {"bdf2", [] { return bdf2(); }, 2},
                          {"generalized_alpha", [] { return generalized_alpha(0.8); }, 2},
                          {"generalized_alpha 0", [] { return generalized_alpha(0); }, 2},
                          {"newmark", [] { return newmark(); }, 2},
                          {"implicit_midpoint", [] { return implicit_midpoint(); }, 2}};

// One tet column that slides along x on supports, so that its one free surface moves as a spring with a mass:
// the linear material keeps it a harmonic oscillator.
World oscillator(const SchemePtr& scheme, BodyId& body, double poisson = 0, double force = 1) {
  WorldOptions options = test::dynamic_options();
  options.scheme = scheme;
  options.force_tolerance = 1e-10;
  World world = test::make_world(options);
  BoxMeshDef def;
  def.upper = {0.1, 0.1, 0.1};
  body =
      test::add_body(world, test::value(box_mesh(def)), Element::tet4, test::neo_hookean(1e4, poisson), 1000);
  test::add_volume(world, body);
  test::hold(world, body, {"x0"});
  if (poisson == 0) test::hold(world, body, {"y0", "y1", "z0", "z1"}, {{0, 1, 0}, {0, 0, 1}});
  TractionDef push;
  push.body = body;
  push.surface = "x1";
  push.traction = {force, 0, 0};
  push.amount = Curve::constant(1);
  test::value(world.add(traction(push)));
  return world;
}

double tip_after(const SchemePtr& scheme, double duration, int steps) {
  BodyId body;
  World world = oscillator(scheme, body);
  for (int k = 0; k < steps; ++k) must_step(world, duration / steps);
  return test::displacement_at(world, body, {0.1, 0.1, 0.1}).x;
}

}  // namespace

TEST_CASE("schemes converge at their order") {
  // Stiffness E A / L = 1000 N/m on the lumped mass of the free face: a period near 0.14 s.
  constexpr double kDuration = 0.05;
  const double reference = tip_after(generalized_alpha(0.8), kDuration, 4096);
  for (const Named& s : kSchemes) {
    INFO(s.name);
    const double coarse = std::abs(tip_after(s.make(), kDuration, 64) - reference);
    const double fine = std::abs(tip_after(s.make(), kDuration, 128) - reference);
    const double order = std::log2(coarse / fine);
    INFO("errors " << coarse << " " << fine);
    CHECK(order > s.order - 0.25);
    CHECK(order < s.order + 0.6);
  }
}

TEST_CASE("schemes keep energy and momentum as their theory says") {
  // A bar released under a constant load: elastic + kinetic energy less the load's work starts from zero.
  for (const Named& s : kSchemes) {
    INFO(s.name);
    BodyId body;
    World world = oscillator(s.make(), body);
    const double h = 0.002;
    double largest = 0, last = 0;
    for (int k = 0; k < 200; ++k) {
      must_step(world, h);
      const double work = 1 * 0.01 * test::displacement_at(world, body, {0.1, 0.1, 0.1}).x;
      last = world.elastic_energy() + world.kinetic_energy() - work;
      largest = std::max(largest, world.kinetic_energy());
    }
    if (std::string(s.name) == "newmark" || std::string(s.name) == "implicit_midpoint") {
      CHECK(std::abs(last) < 0.05 * largest);
    } else {
      INFO(last / largest);
      CHECK(last < 0.02 * largest);  // no gain beyond what the first step misjudged
    }
    if (std::string(s.name) == "implicit_euler") CHECK(last < -0.3 * largest);
  }
}

TEST_CASE("free fall is exact to the order of the scheme") {
  for (const Named& s : kSchemes) {
    INFO(s.name);
    WorldOptions options = test::dynamic_options();
    options.scheme = s.make();
    options.gravity = {0, 0, -10};
    World world = test::make_world(options);
    const BodyId body = test::add_body(world, test::value(box_mesh({})), Element::tet4_edge_smoothed,
                                       test::neo_hookean(1e4, 0.5));
    test::add_volume(world, body);
    const int steps = 50;
    for (int k = 0; k < steps; ++k) must_step(world, 0.01);
    // Implicit Euler falls h/2 t too far for each g, the others by what their first step left.
    const double exact = -0.5 * 10 * 0.5 * 0.5, first_order = 0.5 * 10 * 0.5 * 0.01;
    const double z = test::displacement_at(world, body, {0, 0, 0}).z;
    if (s.order == 1)
      CHECK(z == Approx(exact - first_order).epsilon(1e-8));
    else
      CHECK(std::abs(z - exact) < 0.05 * first_order);
    CHECK(world.velocities(body)[0].z == Approx(-5).epsilon(1e-8));
    // And stays rigid.
    CHECK(std::abs(test::displacement_at(world, body, {1, 1, 1}).z - z) < 1e-8);
  }
}

TEST_CASE("multipliers of hard rows settle except under the trapezoidal rule") {
  for (const Named& s : kSchemes) {
    INFO(s.name);
    BodyId body;
    World world = oscillator(s.make(), body, 0.5);
    double previous = 0, jump = 0, size = 0;
    for (int k = 0; k < 60; ++k) {
      must_step(world, 0.01);
      const double pressure = world.fields(body).cell_pressure[0];
      if (k >= 55) jump = std::max(jump, std::abs(pressure - previous));
      size = std::max(size, std::abs(pressure));
      previous = pressure;
    }
    INFO("last jumps " << jump << " of " << size);
    if (std::string(s.name) != "newmark") CHECK(jump < 0.5 * size);
    // The midpoint rule meets hard rows in the middle of its steps.
    if (std::string(s.name) != "implicit_midpoint") CHECK(world.measures(body).volume_error < 1e-9);
  }
}

TEST_CASE("a scheme with a past continues from a checkpoint with the same bits") {
  for (const Named& s : kSchemes) {
    INFO(s.name);
    BodyId body;
    World a = oscillator(s.make(), body, 0.5), b = oscillator(s.make(), body, 0.5);
    for (int k = 0; k < 5; ++k) must_step(a, 0.004);
    REQUIRE(b.load(a.save()));
    for (int k = 0; k < 5; ++k) {
      must_step(a, 0.003);
      must_step(b, 0.003);
    }
    CHECK(a.state_hash() == b.state_hash());
  }
}

TEST_CASE("a spectral radius outside its range is refused") {
  WorldOptions options = test::dynamic_options();
  options.scheme = generalized_alpha(1.5);
  const auto world = World::create(options);
  REQUIRE_FALSE(world);
  CHECK(world.error().find("spectral radius") != std::string::npos);
}
