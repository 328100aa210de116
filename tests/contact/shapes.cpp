// Signed distances to obstacles, and who counts as passing through one.
#include <cmath>
#include <random>

#include "catch.h"
#include "constraints/contact/shape/obstacle_shape.h"

using namespace isochor;

namespace {

Obstacle shaped(ObstacleShape shape) {
  Obstacle o;
  o.shape = shape;
  o.radius = 0.6;
  o.length = 1.4;
  o.size = {1.1, 0.8, 0.5};
  return o;
}

constexpr ObstacleShape kShapes[] = {ObstacleShape::plane, ObstacleShape::sphere, ObstacleShape::capsule,
                                     ObstacleShape::cylinder, ObstacleShape::box};

double length(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

}  // namespace

TEST_CASE("distances have exact derivatives") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const ObstacleShape shape : kShapes) {
    for (const double rounding : {0.0, 0.05}) {
      Obstacle o = shaped(shape);
      if (shape == ObstacleShape::box || shape == ObstacleShape::cylinder) o.rounding = rounding;
      INFO("shape " << static_cast<int>(shape) << ", rounding " << o.rounding);
      int smooth = 0;
      for (int k = 0; k < 300; ++k) {
        const Vec3 y = 1.2 * Vec3{unit(random), unit(random), unit(random)};
        const Vec3 d{unit(random), unit(random), unit(random)};
        const Distance at_y = distance_to(o, y);
        CHECK(length(at_y.normal) == Approx(1).epsilon(1e-14));
        const double h = 1e-5;
        const Distance up = distance_to(o, y + h * d), down = distance_to(o, y - h * d);
        // Curvature jumps where the nearest part changes (an edge, the cap of a capsule).
        Mat3 jump = up.curvature;
        double change = 0;
        for (std::size_t i = 0; i < 9; ++i) change += std::abs(jump.m[i] - down.curvature.m[i]);
        if (change > 1e-2 || length(up.normal - down.normal) > 1e-2) continue;
        ++smooth;
        CHECK((up.value - down.value) / (2 * h) == Approx(dot(at_y.normal, d)).margin(1e-8));
        const Vec3 slope = (1 / (2 * h)) * (up.normal - down.normal);
        CHECK(length(slope - at_y.curvature * d) < 1e-6);
      }
      CHECK(smooth > 250);
    }
  }
}

TEST_CASE("distances are distances to the surface") {
  // From any point, the step against the normal by the distance ends on the surface.
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const ObstacleShape shape : kShapes) {
    INFO("shape " << static_cast<int>(shape));
    const Obstacle o = shaped(shape);
    for (int k = 0; k < 100; ++k) {
      const Vec3 y = 1.5 * Vec3{unit(random), unit(random), unit(random)};
      const Distance d = distance_to(o, y);
      CHECK(std::abs(distance_value(o, y - d.value * d.normal)) < 1e-12);
    }
  }
  CHECK(distance_value(shaped(ObstacleShape::box), {1.55, 0, 0}) == Approx(1));
  CHECK(distance_value(shaped(ObstacleShape::cylinder), {0.9, 0, 1.1}) == Approx(0.5));
  CHECK(distance_value(shaped(ObstacleShape::capsule), {0, 0, 2.3}) == Approx(1));
}

TEST_CASE("an obstacle's own axes follow axis, side and motion") {
  Obstacle o = shaped(ObstacleShape::box);
  o.position = {1, 2, 3};
  o.axis = {0, 0, 2};
  o.side = {0, 3, 1};
  ObstaclePose p = pose_of(o, 0);
  CHECK(length(p.to_world({1, 0, 0}) - Vec3{1, 3, 3}) < 1e-15);
  CHECK(length(p.to_own({1, 2, 4}) - Vec3{0, 0, 1}) < 1e-15);
  // A quarter turn about z at the origin, and up by one.
  o.motion.keys = {{0, {0, 0, 0}, {1, 0, 0, 0}}, {1, {0, 0, 1}, {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}};
  p = pose_of(o, 1);
  CHECK(length(p.position - Vec3{-2, 1, 4}) < 1e-14);
  CHECK(length(p.to_world({1, 0, 0}) - Vec3{-3, 1, 4}) < 1e-14);
  CHECK(length(p.to_own(p.to_world({0.3, 0.4, 0.5})) - Vec3{0.3, 0.4, 0.5}) < 1e-14);
}

TEST_CASE("passing through is told from sliding along and around") {
  Obstacle sheet = shaped(ObstacleShape::box);
  sheet.size = {2, 2, 0.01};
  Vec3 met{};
  REQUIRE(passes_through(sheet, {0.1, 0, 5}, {0.2, 0, -40}, met));
  CHECK(met.z == Approx(0.005).margin(1e-9));
  CHECK(passes_through(sheet, {0.1, 0, 0.005}, {0.1, 0, -0.02}, met));  // from resting on it
  CHECK(passes_through(sheet, {0.1, 0, 0.1}, {0.1, 0, -0.004}, met));   // ends inside, below the middle
  CHECK_FALSE(passes_through(sheet, {0.1, 0, 0.1}, {0.1, 0, 0.004}, met));
  CHECK_FALSE(passes_through(sheet, {0.1, 0, 0.1}, {0.9, 0, 0.005}, met));
  CHECK_FALSE(passes_through(sheet, {1.1, 0, 1}, {1.1, 0, -1}, met));  // beside it
  CHECK_FALSE(passes_through(sheet, {0.1, 0, 0.1}, {0.1, 0, 5}, met));
  const Obstacle ball = shaped(ObstacleShape::sphere);
  CHECK(passes_through(ball, {-2, 0.1, 0}, {2, 0.1, 0}, met));
  CHECK(length(met) == Approx(0.6));
  CHECK_FALSE(passes_through(ball, {-0.6, 0, 0}, {-0.5, 0.35, 0}, met));  // along its surface
  const Obstacle plane = shaped(ObstacleShape::plane);
  CHECK_FALSE(passes_through(plane, {0, 0, 1}, {0, 0, -1}, met));  // one-sided: the gap says it all
}
