// Obstacles that are moved into bodies, far within one step: where a body ends does not depend on the steps.
#include <array>
#include <cmath>
#include <random>

#include "solid_shapes.h"

namespace {

using namespace isochor;

double norm_of(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

constexpr double kCell = 1.0 / 6;

// A tool of some shape above a block, and the way it goes: down by one to two cells, and aside.
struct Approach {
  Obstacle tool;
  bool hexahedra = false, stvk = false;
  std::string text;
};

Approach approach(std::uint32_t seed) {
  std::mt19937 engine(seed);
  const auto draw = [&engine](double low, double high) {
    return low + (high - low) * static_cast<double>(engine() >> 8) / static_cast<double>(1 << 24);
  };
  Approach a;
  Obstacle& o = a.tool;
  const int shape = static_cast<int>(seed % 5);
  const double thick = draw(0.4, 2.5) * kCell;  // thinner and thicker than the way
  double above = 0.5 * thick;
  if (shape == 0 || shape == 1) {
    o.shape = ObstacleShape::box;
    o.size = {3, 3, thick};
    // With sides that end somewhere over the block.
    if (shape == 1) o.size = {draw(0.5, 0.7), 3, thick};
  } else if (shape == 2) {
    o.shape = ObstacleShape::cylinder;
    o.axis = {0, 0, 1};
    o.radius = draw(0.3, 0.4);
    o.length = thick;
  } else if (shape == 3) {
    o.shape = ObstacleShape::sphere;
    o.radius = above = draw(0.5, 1.0);
  } else {
    o = test::mesh_obstacle(test::box_surface({3, 3, thick}));
  }
  o.position = {0.5, 0.5, 1 + above};
  // St. Venant-Kirchhoff materials collapse under little more.
  a.stvk = seed % 3 == 0;
  const double way = draw(1.0, a.stvk ? 1.2 : 1.8) * kCell;
  // Where sides end over the block, what goes aside may be on either side of what it meets.
  const double drift = shape == 1 || shape == 2 ? 0 : 0.05;
  const Vec3 aside{drift * draw(-1, 1), drift * draw(-1, 1), -way};
  o.motion.keys = {{0, {}, {1, 0, 0, 0}}, {1, aside, {1, 0, 0, 0}}};
  a.hexahedra = seed % 2 == 0;
  a.text = "seed " + std::to_string(seed) + ", shape " + std::to_string(shape) + ", thickness " +
           std::to_string(thick) + ", way " + std::to_string(way);
  return a;
}

std::vector<Vec3> pressed(const Approach& a, int steps) {
  World world = test::make_world(test::static_options());
  ElasticConstants c;
  c.young = 1e5;
  c.poisson = 0.3;
  const BodyId body = test::add_body(
      world, test::block({0, 0, 0}, {1, 1, 1}, {6, 6, 6}, a.hexahedra ? CellType::hex8 : CellType::tet4),
      a.hexahedra ? Element::hex8 : Element::tet4, test::value(a.stvk ? stvk(c) : neo_hookean(c)));
  test::hold(world, body, {"z0"});
  ContactDef def;
  def.body = body;
  def.surfaces = {"z1"};
  def.obstacle = a.tool;
  test::value(world.add(contact(def)));
  for (int k = 0; k < steps; ++k) test::must_advance(world, 1.0 / steps);
  CHECK(test::gauge(world, "contact_area") > 0);
  CHECK(test::gauge(world, "smallest_gap") > -1e-9);
  CHECK(world.measures(body).min_J > 0.1);
  const auto x = world.positions(body);
  return {x.begin(), x.end()};
}

}  // namespace

TEST_CASE("a body ends in the same place whether an obstacle arrives in one step or in many") {
  for (std::uint32_t seed = 1; seed <= 15; ++seed) {
    const Approach a = approach(seed);
    INFO(a.text);
    const std::vector<Vec3> many = pressed(a, 24);
    for (const int steps : {1, 4}) {
      const std::vector<Vec3> few = pressed(a, steps);
      double worst = 0;
      for (std::size_t i = 0; i < few.size(); ++i) worst = std::max(worst, norm_of(few[i] - many[i]));
      INFO(steps << " steps: " << worst);
      CHECK(worst < 0.02 * kCell);
    }
  }
}

// In exact numbers the nodes are beneath the face that comes down; in rounded ones they are on its edge.
TEST_CASE("an obstacle as wide as a body presses it as a wider one does") {
  const auto force = [](const Obstacle& tool, double turn, const Vec3& shift) {
    World world = test::make_world(test::static_options());
    const double c = std::cos(turn), s = std::sin(turn);
    const auto placed = [&](const Vec3& p) {
      return Vec3{c * p.x - s * p.y, s * p.x + c * p.y, p.z} + shift;
    };
    const BodyId body = test::add_body(
        world, test::mapped(test::block({0, 0, 0}, {1, 0.1, 0.5}, {8, 1, 4}, CellType::hex8), placed),
        Element::hex8, test::neo_hookean(1e5, 0.3));
    test::hold(world, body, {"z0"});
    test::hold(world, body, {"y0", "y1"}, {{-s, c, 0}});
    ContactDef def;
    def.body = body;
    def.surfaces = {"z1"};
    def.obstacle = tool;
    def.obstacle.side = {c, s, 0};
    def.obstacle.position = placed({0.5, 0.05, 0.55 + 0.001});
    def.obstacle.motion.keys = {{0, {}, {1, 0, 0, 0}}, {1, {0, 0, -0.061}, {1, 0, 0, 0}}};
    test::value(world.add(contact(def)));
    for (int k = 0; k < 3; ++k) test::must_advance(world, 1.0 / 3);
    return -test::gauge(world, "force_z");
  };
  const auto box = [](const Vec3& size) {
    Obstacle o;
    o.shape = ObstacleShape::box;
    o.size = size;
    return o;
  };
  const double wide = force(box({2, 0.3, 0.1}), 0, {});
  CHECK(wide > 100);
  for (const double turn : {0.0, 0.3, 1.1}) {
    for (const Vec3& shift : {Vec3{}, Vec3{0.1, 1.0 / 3, 0.7}}) {
      INFO("turned by " << turn << ", moved by " << shift.x);
      CHECK(force(box({2, 0.1, 0.1}), turn, shift) == Approx(wide).epsilon(1e-6));
      CHECK(force(test::mesh_obstacle(test::box_surface({2, 0.1, 0.1})), turn, shift) ==
            Approx(wide).epsilon(1e-6));
    }
  }
}

// A plate ten times as high as thick buckles at a compression of 0.8 %. Held in its plane it does not; free,
// it leans to one side, and either way ends where many steps do.
TEST_CASE("a plate that gives way to an obstacle ends in the same shape in one step and in many") {
  const auto force = [](bool held, int steps) {
    World world = test::make_world(test::static_options());
    const BodyId body =
        test::add_body(world, test::block({-0.5, 0, 0}, {0.5, 1, 0.1}, {10, 10, 1}, CellType::hex8),
                       Element::hex8, test::neo_hookean(1, 0.3));
    test::hold(world, body, {"y0"});
    if (held) test::hold(world, body, {"z0", "z1"}, {{0, 0, 1}});
    ContactDef def;
    def.body = body;
    def.surfaces = {"y1"};
    def.obstacle = test::mesh_obstacle(test::box_surface({4, 0.1, 4}));
    def.obstacle.position = {0, 1.05, 0};
    def.obstacle.motion.keys = {{0, {}, {1, 0, 0, 0}}, {1, {0, -0.15, 0}, {1, 0, 0, 0}}};
    test::value(world.add(contact(def)));
    for (int k = 0; k < steps; ++k) test::must_advance(world, 1.0 / steps);
    return std::abs(test::gauge(world, "force_y"));
  };
  const double flat = force(true, 1), leaning = force(false, 1);
  CHECK(flat == Approx(force(true, 10)).epsilon(1e-6));
  CHECK(leaning == Approx(force(false, 10)).epsilon(1e-6));
  CHECK(leaning < 0.1 * flat);
}
