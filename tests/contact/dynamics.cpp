// Impacts: nothing gets in, nothing sticks, no energy appears.
#include <cmath>

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

struct Drop {
  World world;
  BodyId body{};
};

// A soft cube above a floor, tilted so that a corner meets it first.
Drop dropped_cube(double height, double tilt, const WorldOptions& base = test::dynamic_options()) {
  WorldOptions options = base;
  options.gravity = {0, 0, -9.81};
  Drop d{test::make_world(options), {}};
  BoxMeshDef def;
  def.lower = {-0.05, -0.05, -0.05};
  def.upper = {0.05, 0.05, 0.05};
  def.divisions = {3, 3, 3};
  const Mesh mesh = test::mapped(test::value(box_mesh(def)), [&](const Vec3& p) {
    const double c = std::cos(tilt), s = std::sin(tilt);
    const Vec3 q{c * p.x + s * p.z, p.y, -s * p.x + c * p.z};
    return Vec3{q.x, c * q.y + s * q.z, -s * q.y + c * q.z + 0.05 + height};
  });
  d.body = test::add_body(d.world, mesh, Element::tet4_edge_smoothed, test::neo_hookean(5e4, 0.5));
  test::add_volume(d.world, d.body);
  ContactDef contact_def;
  contact_def.body = d.body;
  test::value(d.world.add(contact(contact_def)));
  return d;
}

}  // namespace

TEST_CASE("a dropped cube keeps its volume through the impact, at short and long steps") {
  for (const double h : {1e-3, 1e-2}) {
    for (const double tilt : {0.0, 0.6}) {
      INFO("h " << h << ", tilt " << tilt);
      Drop d = dropped_cube(0.06, tilt);
      double worst_volume = 0, worst_gap = 0, worst_residual = 0;
      bool touched = false;
      for (double t = 0; t < 0.2 - 1e-9; t += h) {
        const StepReport r = d.world.advance(h);
        INFO("t " << t << " " << r.reason);
        REQUIRE(r.status == StepStatus::converged);
        worst_volume = std::max(worst_volume, std::abs(d.world.measures(d.body).volume_error));
        worst_gap = std::min(worst_gap, gauge_of(d.world, "smallest_gap"));
        worst_residual = std::max(worst_residual, d.world.constitutive_residual());
        const double normal = gauge_of(d.world, "normal_force");
        CHECK(normal >= 0);
        touched = touched || normal > 1;
      }
      CHECK(touched);
      CHECK(worst_volume < 1e-8);
      CHECK(worst_gap > -1e-9);
      CHECK(worst_residual < 1e-8);
    }
  }
}

TEST_CASE("implicit Euler gains no energy, neither in free fall nor in an impact") {
  Drop d = dropped_cube(0.04, 0.3);
  const Mesh& mesh = d.world.mesh(d.body);
  // Gravity acts on lumped masses.
  std::vector<double> mass(mesh.nodes.size(), 0);
  for (std::size_t c = 0; c < mesh.cells.size(); c += 4) {
    const auto X = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(mesh.cells[c + k])]; };
    const double volume = dot(X(1) - X(0), cross(X(2) - X(0), X(3) - X(0))) / 6;
    for (std::size_t k = 0; k < 4; ++k) mass[static_cast<std::size_t>(mesh.cells[c + k])] += 250 * volume;
  }
  const double drop = 1e-3 * 1000 * 9.81 * 0.04;
  double last = 1e300, largest = 0;
  for (int k = 0; k < 200; ++k) {
    test::must_advance(d.world, 1e-3);
    double energy = d.world.kinetic_energy() + d.world.elastic_energy();
    const auto x = d.world.positions(d.body);
    for (std::size_t i = 0; i < x.size(); ++i) energy += mass[i] * 9.81 * x[i].z;
    if (k > 0) CHECK(energy < last + 1e-9 * drop);
    last = energy;
    largest = std::max(largest, gauge_of(d.world, "normal_force"));
  }
  CHECK(largest > 3 * 9.81);
}

TEST_CASE("a block that flies a hundred elements a step does not tunnel through a thin sheet") {
  for (const double speed : {1.25, 5.0}) {
    INFO("speed " << speed);
    WorldOptions options = test::dynamic_options();
    options.smallest_fraction = 1e-4;
    World world = test::make_world(options);
    BoxMeshDef def;
    def.lower = {0, -0.05, -0.05};
    def.upper = {0.1, 0.05, 0.05};
    def.divisions = {3, 3, 3};
    const BodyId body = test::add_body(world, test::value(box_mesh(def)), Element::tet4_edge_smoothed,
                                       test::neo_hookean(1e6, 0.45));
    // The sheet comes at the block: the same to the engine as a block that flies.
    ContactDef sheet;
    sheet.body = body;
    sheet.obstacle.shape = ObstacleShape::box;
    sheet.obstacle.size = {0.005, 1, 1};
    sheet.obstacle.position = {1, 0, 0};
    const double h = 0.5;  // 25 and 100 elements a step
    sheet.obstacle.motion.keys = {{0, {0, 0, 0}, {1, 0, 0, 0}}, {10, {-10 * speed, 0, 0}, {1, 0, 0, 0}}};
    test::value(world.add(contact(sheet)));
    double t = 0;
    for (int k = 0; k < (speed < 2 ? 3 : 1); ++k) {
      const StepReport r = world.advance(h);
      INFO(r.reason);
      REQUIRE(r.status == StepStatus::converged);
      t += h;
      const double front = 1 - speed * t - 0.0025;
      for (const Vec3& x : world.positions(body)) CHECK(x.x < front + 1e-6);
    }
  }
}
