// Soft bodies against triangle meshes and distance fields, held against the shapes that they stand for.
#include <cmath>

#include "constraints/contact/shape/obstacle_shape.h"
#include "solid_shapes.h"

namespace {

using namespace isochor;

double gauge_of(const World& world, const std::string& effect, const std::string& quantity) {
  for (const Gauge& g : world.gauges()) {
    if (g.effect == effect && g.quantity == quantity) return g.value;
  }
  FAIL("no gauge " << effect << ", " << quantity);
  return 0;
}

// A block whose top is pressed by a ball that comes down by `depth`, and turns as it does.
struct Press {
  double force = 0, area = 0, gap = 0;
  int iterations = 0;
};
Press press(Obstacle ball, double depth, double turn = 0) {
  World world = test::make_world(test::static_options());
  const BodyId body = test::add_body(world, test::box({8, 8, 4}, {1, 1, 0.5}), Element::tet4_edge_smoothed,
                                     test::neo_hookean(1e5, 0.45));
  test::add_volume(world, body);
  test::hold(world, body, {"z0"});
  ball.position = {0.5, 0.5, 0.5 + 0.6};
  // Turns about its own middle.
  const double c = std::cos(0.5 * turn), s = std::sin(0.5 * turn);
  const Vec3 middle = ball.position;
  const double C = std::cos(turn), S = std::sin(turn);
  const Vec3 moved{C * middle.x - S * middle.y, S * middle.x + C * middle.y, middle.z};
  const Vec3 shift = middle - moved + Vec3{0, 0, -depth};
  ball.motion.keys = {{0, {}, {1, 0, 0, 0}}, {1, shift, {c, 0, 0, s}}};
  ContactDef def;
  def.body = body;
  def.surfaces = {"z1"};
  def.obstacle = ball;
  test::value(world.add(contact(def)));
  const StepReport report = test::must_advance(world);
  return {-gauge_of(world, "contact", "force_z"), gauge_of(world, "contact", "contact_area"),
          gauge_of(world, "contact", "smallest_gap"), report.iterations};
}

}  // namespace

TEST_CASE("a sphere of triangles and its field press like the sphere") {
  Obstacle sphere;
  sphere.shape = ObstacleShape::sphere;
  sphere.radius = 0.6;
  const Press exact = press(sphere, 0.12);
  REQUIRE(exact.force > 100);
  const TriangleSurface surface = test::ball_surface(0.6, 5);
  for (const Obstacle& o : {test::mesh_obstacle(surface), test::field_obstacle(surface, 0.03)}) {
    for (const double turn : {0.0, 0.4}) {
      const Press p = press(o, 0.12, turn);
      INFO("shape " << static_cast<int>(o.shape) << ", turn " << turn << ": force " << p.force << " against "
                    << exact.force << ", iterations " << p.iterations << " against " << exact.iterations);
      CHECK(p.force == Approx(exact.force).epsilon(0.01));
      CHECK(p.area == Approx(exact.area).epsilon(1e-12));
      CHECK(p.gap > -1e-9);
    }
  }
}

TEST_CASE("a coarse sphere of triangles that has grown by its rounding presses as large as it is") {
  // Its points lie on the sphere less the rounding, its faces inside.
  Obstacle sphere;
  sphere.shape = ObstacleShape::sphere;
  sphere.radius = 0.6;
  const Press exact = press(sphere, 0.12);
  Obstacle grown = test::mesh_obstacle(test::ball_surface(0.5, 3));
  grown.rounding = 0.1;
  const Press p = press(grown, 0.12);
  INFO("force " << p.force << " against " << exact.force);
  CHECK(p.force < exact.force);
  CHECK(p.force == Approx(exact.force).epsilon(0.06));
  CHECK(p.gap > -1e-9);
}

TEST_CASE("a soft ball settles in a round hollow of a distance field") {
  WorldOptions options = test::dynamic_options();
  options.gravity = {0, 0, -9.81};
  World world = test::make_world(options);
  // A cube rounded to a ball of radius 0.2.
  const Mesh ball = test::mapped(test::box({4, 4, 4}, {2, 2, 2}), [](const Vec3& q) {
    const Vec3 p = q - Vec3{1, 1, 1};
    const double square = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), l = std::sqrt(dot(p, p));
    return (l > 0 ? 0.2 * square / l : 0.0) * p + Vec3{0.62, 0.45, 1.08};
  });
  const BodyId body = test::add_body(world, ball, Element::tet4_edge_smoothed, test::neo_hookean(3e4, 0.49));
  test::add_volume(world, body);
  ContactDef def;
  def.body = body;
  def.obstacle = test::field_obstacle(test::bowl_surface(0.5), 0.04);
  test::value(world.add(contact(def)));
  double deepest = 0;
  for (int k = 0; k < 100; ++k) {
    test::must_advance(world, 0.03);
    deepest = std::min(deepest, gauge_of(world, "contact", "smallest_gap"));
  }
  CHECK(deepest > -1e-9);
  // It carries its weight and has rolled or slid toward the middle.
  Vec3 middle{};
  const auto x = world.positions(body);
  for (const Vec3& p : x) middle += (1 / static_cast<double>(x.size())) * p;
  CHECK(std::abs(middle.x - 0.5) < 0.06);
  CHECK(std::abs(middle.y - 0.5) < 0.06);
  CHECK(middle.z < 1.0);
  CHECK(world.constitutive_residual() < 1e-8);
}

TEST_CASE("a block does not tunnel through a thin wall of triangles") {
  WorldOptions options = test::dynamic_options();
  options.smallest_fraction = 1e-4;
  World world = test::make_world(options);
  BoxMeshDef box;
  box.lower = {0, -0.05, -0.05};
  box.upper = {0.1, 0.05, 0.05};
  box.divisions = {3, 3, 3};
  const BodyId body = test::add_body(world, test::value(box_mesh(box)), Element::tet4_edge_smoothed,
                                     test::neo_hookean(1e6, 0.45));
  test::add_volume(world, body);
  ContactDef sheet;
  sheet.body = body;
  sheet.obstacle = test::mesh_obstacle(test::box_surface({0.005, 1, 1}, {1, 4, 4}));
  sheet.obstacle.position = {1, 0, 0};
  const double speed = 5;  // a hundred elements a step
  sheet.obstacle.motion.keys = {{0, {0, 0, 0}, {1, 0, 0, 0}}, {10, {-10 * speed, 0, 0}, {1, 0, 0, 0}}};
  test::value(world.add(contact(sheet)));
  const StepReport r = world.advance(0.5);
  INFO(r.reason);
  REQUIRE(r.status == StepStatus::converged);
  for (const Vec3& x : world.positions(body)) CHECK(x.x < 1 - speed * 0.5 - 0.0025 + 1e-6);
}

TEST_CASE("a free body of triangles falls, weighs and comes to rest like the box that it is") {
  std::array<std::array<double, 4>, 2> found{};
  for (std::size_t k = 0; k < 2; ++k) {
    WorldOptions options = test::dynamic_options();
    options.gravity = {0, 0, -9.81};
    World world = test::make_world(options);
    const BodyId far = test::add_body(world, test::box({1, 1, 1}), Element::tet4_edge_smoothed,
                                      test::neo_hookean(5e4, 0.49));
    test::hold(world, far, {"z0"});
    RigidBodyDef def;
    def.name = "thing";
    def.shape.shape = ObstacleShape::box;
    def.shape.size = {0.1, 0.2, 0.06};
    def.shape.axis = {0.3, 0.1, 1};
    const Vec3 place{3, 0, 0.12};
    def.shape.position = place;
    if (k == 1) {
      // The same box, its own origin in a corner.
      TriangleSurface s = test::box_surface(def.shape.size, {1, 1, 1});
      const Vec3 corner = 0.5 * def.shape.size;
      for (Vec3& p : s.points) p += corner;
      def.shape.shape = ObstacleShape::mesh;
      def.shape.solid = test::value(mesh_solid(s));
      def.shape.position = {};
      def.shape.position = place - pose_of(def.shape, 0).R * corner;
    }
    test::value(world.add(rigid_body(def)));
    ContactDef floor;
    floor.name = "floor";
    floor.rigid = "thing";
    floor.friction = 0.4;
    test::value(world.add(contact(floor)));
    CHECK(gauge_of(world, "thing", "z") == Approx(0.12));
    for (int step = 0; step < 120; ++step) test::must_advance(world, 0.005);
    found[k] = {gauge_of(world, "thing", "z"), gauge_of(world, "thing", "speed"),
                gauge_of(world, "thing", "turn"), gauge_of(world, "floor", "normal_force")};
    CHECK(found[k][0] == Approx(0.03).epsilon(1e-6));
    CHECK(found[k][1] < 1e-4);
    CHECK(found[k][3] == Approx(1.2 * 9.81).epsilon(1e-3));
  }
  CHECK(found[1][2] == Approx(found[0][2]).epsilon(1e-2));
}
