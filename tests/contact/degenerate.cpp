// Contacts that are easy to get wrong: corners, edges, held nodes, no weight at all.
#include <cmath>

#include "isochor/contact.h"
#include "support/worlds.h"

namespace {

using namespace isochor;

BodyId add_cube(World& world, const Vec3& lower, const Vec3& upper, std::array<int, 3> divisions,
                double poisson = 0.5) {
  BoxMeshDef def;
  def.lower = lower;
  def.upper = upper;
  def.divisions = divisions;
  const BodyId body = test::add_body(world, test::value(box_mesh(def)), Element::tet4_edge_smoothed,
                                     test::neo_hookean(5e4, poisson));
  test::add_volume(world, body);
  return body;
}

double gauge_of(const World& world, const std::string& effect, const std::string& quantity) {
  for (const Gauge& g : world.gauges()) {
    if (g.effect == effect && g.quantity == quantity) return g.value;
  }
  FAIL("no gauge " << effect << ", " << quantity);
  return 0;
}

}  // namespace

TEST_CASE("a block in the corner of three planes rests on all of them, held by nothing else") {
  WorldOptions options = test::static_options();
  options.gravity = {-3, -4, -9};
  World world = test::make_world(options);
  const BodyId body = add_cube(world, {0, 0, 0}, {0.1, 0.1, 0.1}, {3, 3, 3});
  const std::string names[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    ContactDef wall;
    wall.name = names[k];
    wall.body = body;
    wall.obstacle.axis = {};
    wall.obstacle.axis[k] = 1;
    test::value(world.add(contact(wall)));
  }
  test::must_advance(world);
  for (int k = 0; k < 3; ++k) {
    CHECK(gauge_of(world, names[k], "normal_force") == Approx(-options.gravity[k]).epsilon(1e-7));
    CHECK(gauge_of(world, names[k], "smallest_gap") > -1e-10);
  }
}

TEST_CASE("a block tips over a rounded edge and falls off, never inside") {
  WorldOptions options = test::dynamic_options();
  options.gravity = {0, 0, -9.81};
  World world = test::make_world(options);
  const BodyId body = add_cube(world, {-0.04, -0.03, 0}, {0.08, 0.03, 0.04}, {6, 2, 2});
  ContactDef table;
  table.body = body;
  table.obstacle.shape = ObstacleShape::box;
  table.obstacle.size = {0.4, 0.4, 0.2};
  table.obstacle.position = {-0.2, 0, -0.1};
  table.obstacle.rounding = 0.02;
  table.friction = 0.3;
  test::value(world.add(contact(table)));
  double lowest_gap = 0;
  for (int k = 0; k < 80; ++k) {
    test::must_advance(world, 0.01);
    lowest_gap = std::min(lowest_gap, gauge_of(world, "contact", "smallest_gap"));
  }
  CHECK(lowest_gap > -1e-9);
  double highest = -1;
  for (const Vec3& x : world.positions(body)) highest = std::max(highest, x.z);
  CHECK(highest < -0.02);
}

TEST_CASE("held nodes inside an obstacle stay where they are held") {
  World world = test::make_world(test::static_options());
  const BodyId body = add_cube(world, {0, 0, 0}, {0.1, 0.1, 0.1}, {3, 3, 3}, 0.45);
  // The lower side is pushed into the floor by its support; what is not held meets the floor.
  test::hold(world, body, {"x0"}, {}, {0, 0, -0.02});
  ContactDef floor;
  floor.body = body;
  test::value(world.add(contact(floor)));
  test::must_advance(world);
  const auto rest = world.rest_positions(body), x = world.positions(body);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (rest[i].x < 1e-9)
      CHECK(x[i].z == Approx(rest[i].z - 0.02));
    else
      CHECK(x[i].z > -1e-10);
  }
}

TEST_CASE("a scene in which nothing touches is solved as without contact") {
  std::array<std::vector<Vec3>, 2> positions;
  for (std::size_t with = 0; with < 2; ++with) {
    WorldOptions options = test::dynamic_options();
    options.gravity = {0, 0, -9.81};
    World world = test::make_world(options);
    const BodyId body = add_cube(world, {0, 0, 0}, {0.1, 0.1, 0.1}, {3, 3, 3});
    test::hold(world, body, {"x0"});
    ContactDef floor;
    floor.body = body;
    floor.obstacle.position.z = -1;
    floor.friction = 0.5;
    if (with == 1) test::value(world.add(contact(floor)));
    for (int k = 0; k < 10; ++k) test::must_advance(world, 0.01);
    positions[with].assign(world.positions(body).begin(), world.positions(body).end());
  }
  for (std::size_t i = 0; i < positions[0].size(); ++i) {
    const Vec3 d = positions[1][i] - positions[0][i];
    CHECK(dot(d, d) < 1e-18);
  }
}

TEST_CASE("a state with friction is saved, restored and continued to the last bit") {
  const auto make = [] {
    WorldOptions options = test::dynamic_options();
    options.gravity = {4, 0, -9.81};
    World world = test::make_world(options);
    const BodyId body = add_cube(world, {0, 0, 0}, {0.1, 0.1, 0.05}, {3, 3, 2});
    ContactDef floor;
    floor.body = body;
    floor.surfaces = {"z0"};
    floor.friction = 0.6;
    test::value(world.add(contact(floor)));
    return world;
  };
  World a = make(), b = make();
  for (int k = 0; k < 5; ++k) test::must_advance(a, 0.01);
  const auto saved = a.save();
  REQUIRE(b.load(saved));
  CHECK(a.state_hash() == b.state_hash());
  for (int k = 0; k < 3; ++k) {
    test::must_advance(a, 0.01);
    test::must_advance(b, 0.01);
  }
  CHECK(a.state_hash() == b.state_hash());
}
