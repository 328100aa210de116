// Solids of triangles and of distances on a grid: distances, derivatives, ways through, and what is refused.
#include <random>

#include "constraints/contact/shape/obstacle_shape.h"
#include "solid_shapes.h"

using namespace isochor;

namespace {

double length(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

struct Random {
  std::mt19937 engine{17};
  std::uniform_real_distribution<double> unit{-1, 1};
  Vec3 operator()(double scale = 1) { return scale * Vec3{unit(engine), unit(engine), unit(engine)}; }
};

}  // namespace

TEST_CASE("a box of triangles has the distances of a box") {
  const Vec3 size{1.1, 0.8, 0.5};
  const Obstacle mesh = test::mesh_obstacle(test::box_surface(size));
  Obstacle box;
  box.shape = ObstacleShape::box;
  box.size = size;
  Random random;
  int inside = 0;
  for (int k = 0; k < 2000; ++k) {
    const Vec3 y = random();
    const Distance a = distance_to(mesh, y), b = distance_to(box, y);
    CHECK(a.value == Approx(b.value).margin(1e-14));
    CHECK(distance_value(mesh, y) == a.value);
    CHECK(length(a.normal - b.normal) < 1e-9);
    double difference = 0;
    for (std::size_t i = 0; i < 9; ++i) difference += std::abs(a.curvature.m[i] - b.curvature.m[i]);
    CHECK(difference < 1e-6);
    inside += b.value < 0;
  }
  CHECK(inside > 50);
  // Exactly above edges and corners inside a flat side, where directions from the nearest point are noise.
  for (const Vec3& p : test::box_surface(size).points) {
    if (std::abs(p.z) < 0.25 - 1e-9 || std::abs(p.x) > 0.5 || std::abs(p.y) > 0.39) continue;
    for (const double gap : {1e-13, 1e-9, 1e-3}) {
      const Distance d = distance_to(mesh, {p.x, p.y, p.z + (p.z > 0 ? gap : -gap)});
      CHECK(length(d.normal - Vec3{0, 0, p.z > 0 ? 1.0 : -1.0}) < 1e-12);
      for (const double c : d.curvature.m) CHECK(c == 0);
    }
  }
}

TEST_CASE("distances to solids have exact derivatives") {
  Obstacle grown = test::mesh_obstacle(test::ball_surface(0.6, 2));
  grown.rounding = 0.05;
  const std::pair<Obstacle, double> shapes[] = {{test::mesh_obstacle(test::trough_surface()), 1e-7},
                                                {grown, 1e-7},
                                                {test::field_obstacle(test::ball_surface(0.6, 3), 0.1), 1e-4},
                                                {test::field_obstacle(test::trough_surface(), 0.08), 1e-4}};
  Random random;
  for (const auto& [o, tolerance] : shapes) {
    int smooth = 0;
    for (int k = 0; k < 400; ++k) {
      const Vec3 y = random(1.3), d = random();
      const Distance at_y = distance_to(o, y);
      const double h = 1e-6;
      const Distance up = distance_to(o, y + h * d), down = distance_to(o, y - h * d);
      double change = 0, size = 1;
      for (std::size_t i = 0; i < 9; ++i) {
        change += std::abs(up.curvature.m[i] - down.curvature.m[i]);
        size += std::abs(at_y.curvature.m[i]);
      }
      if (change > 1e-3 * size || length(up.normal - down.normal) > 1e-4 * size) continue;
      ++smooth;
      CHECK((up.value - down.value) / (2 * h) == Approx(dot(at_y.normal, d)).margin(1e-8));
      const Vec3 slope = (1 / (2 * h)) * (up.normal - down.normal);
      CHECK(length(slope - at_y.curvature * d) < tolerance * size * size);
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < i; ++j)
          CHECK(at_y.curvature(i, j) == Approx(at_y.curvature(j, i)).margin(1e-12 * size));
      }
    }
    CHECK(smooth > 350);
  }
}

TEST_CASE("a field is twice continuously differentiable, also where its solid has edges") {
  const Obstacle o = test::field_obstacle(test::trough_surface(), 0.1);
  Random random;
  for (int k = 0; k < 200; ++k) {
    const Vec3 y = Vec3{0.5, 0.5, 0.5} + random(0.6), d = random();
    const Distance a = distance_to(o, y), b = distance_to(o, y + 1e-7 * d);
    CHECK(length(a.normal - b.normal) < 1e-5);
    for (std::size_t i = 0; i < 9; ++i) CHECK(std::abs(a.curvature.m[i] - b.curvature.m[i]) < 1e-3);
  }
}

TEST_CASE("a sphere of triangles and its field come to the sphere as they are refined") {
  Random random;
  Obstacle sphere;
  sphere.shape = ObstacleShape::sphere;
  sphere.radius = 0.6;
  double last_mesh = 1, last_field = 1;
  for (int level = 2; level < 5; ++level) {
    const TriangleSurface surface = test::ball_surface(0.6, level);
    const Obstacle mesh = test::mesh_obstacle(surface),
                   field = test::field_obstacle(surface, 0.6 * std::pow(0.5, level));
    double mesh_error = 0, field_error = 0;
    for (int k = 0; k < 300; ++k) {
      Vec3 y = random();
      y = (0.6 + 0.05 * random.unit(random.engine)) / length(y) * y;
      mesh_error = std::max(mesh_error, std::abs(distance_value(mesh, y) - distance_value(sphere, y)));
      field_error = std::max(field_error, std::abs(distance_value(field, y) - distance_value(sphere, y)));
    }
    CHECK(mesh_error < 0.3 * last_mesh);
    CHECK(field_error < 0.3 * last_field);
    last_mesh = mesh_error;
    last_field = field_error;
  }
  CHECK(last_mesh < 2.5e-3);
  CHECK(last_field < 2.5e-3);
}

TEST_CASE("the distance beyond the grid of a field is positive, grows, and is not more than the true one") {
  const TriangleSurface surface = test::box_surface({0.4, 0.3, 0.5});
  const Obstacle field = test::field_obstacle(surface, 0.05), mesh = test::mesh_obstacle(surface);
  Random random;
  for (int k = 0; k < 300; ++k) {
    const Vec3 y = random(3);
    if (distance_value(mesh, y) < 0.2) continue;
    const double d = distance_value(field, y);
    CHECK(d > 0.1);
    CHECK(d <= distance_value(mesh, y) * (1 + 1e-3));
    CHECK(distance_value(field, 1.1 * y) > d);
  }
}

TEST_CASE("passing through a solid is told from sliding along it and from entering a hollow") {
  Vec3 met{};
  const TriangleSurface sheet = test::box_surface({2, 2, 0.04}, {4, 4, 1});
  for (const Obstacle& o : {test::mesh_obstacle(sheet), test::field_obstacle(sheet, 0.02)}) {
    REQUIRE(passes_through(o, {0.1, 0, 5}, {0.2, 0, -40}, met));
    CHECK(met.z == Approx(0.02).margin(1e-3));
    CHECK(passes_through(o, {0.1, 0, 0.02}, {0.1, 0, -0.06}, met));  // from resting on it
    CHECK(passes_through(o, {0.1, 0, 0.1}, {0.1, 0, -0.016}, met));  // ends inside, below the middle
    CHECK_FALSE(passes_through(o, {0.1, 0, 0.1}, {0.1, 0, 0.018}, met));
    CHECK_FALSE(passes_through(o, {0.1, 0, 0.1}, {0.7, 0, 0.02}, met));
    CHECK_FALSE(passes_through(o, {1.3, 0, 1}, {1.3, 0, -1}, met));  // beside it
    CHECK_FALSE(passes_through(o, {0.1, 0, 0.1}, {0.1, 0, 5}, met));
  }
  const TriangleSurface trough = test::trough_surface();
  for (const Obstacle& o : {test::mesh_obstacle(trough), test::field_obstacle(trough, 0.04)}) {
    CHECK_FALSE(passes_through(o, {0.5, 0.5, 2}, {0.5, 0.5, 0.21}, met));  // into the hollow
    CHECK_FALSE(passes_through(o, {0.3, 0.5, 0.5}, {0.7, 0.5, 0.5}, met));
    REQUIRE(passes_through(o, {0.5, 0.5, 0.5}, {-0.5, 0.5, 0.5}, met));  // out through a wall
    CHECK(met.x == Approx(0.2).margin(5e-3));
    // Out through the right wall and on to a place that is beyond the left one.
    CHECK(passes_through(o, {0.5, 0.5, 0.5}, {1.5, 0.5, 0.5}, met));
    CHECK(passes_through(o, {-0.5, 0.5, 0.5}, {1.5, 0.5, 0.5}, met));  // both
    CHECK(passes_through(o, {0.5, 0.5, 0.5}, {0.5, 0.5, -0.5}, met));  // the ground
  }
}

TEST_CASE("surfaces that enclose nothing are refused with place and remedy") {
  const auto why = [](const TriangleSurface& s) {
    const auto made = mesh_solid(s);
    REQUIRE_FALSE(made);
    return made.error();
  };
  const TriangleSurface box = test::box_surface({1, 1, 1}, {1, 1, 1});
  TriangleSurface s = box;
  s.triangles.resize(s.triangles.size() - 3);
  CHECK(
      why(s).starts_with("the surface is open: 3 edges have a triangle on one side only, the first from ("));
  CHECK(why(s).ends_with("m; close the holes, since only a closed surface has an inside"));
  s = box;
  std::swap(s.triangles[0], s.triangles[1]);
  CHECK(why(s).starts_with("the surface is wound both ways: at 3 edges"));
  s = box;
  for (const Vec3& p : box.points) s.points.push_back(p + Vec3{1, 1, 0});
  for (const Index t : box.triangles) s.triangles.push_back(t + static_cast<Index>(box.points.size()));
  CHECK(why(s).starts_with(
      "the surface branches: 1 edges have more than two triangles, the first from (0.5, 0.5"));
  s = box;
  s.points[2].y = std::nan("");
  CHECK(why(s) == "point 2 of the surface is not finite; repair the surface");
  s = box;
  s.triangles[4] = 99;
  CHECK(why(s) == "triangle 1 of the surface names point 99 of 8; correct the indices");
  CHECK(why({}).find("0 corners of triangles") != std::string::npos);
  s.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  s.triangles = {0, 1, 2, 0, 2, 1};
  CHECK(why(s) == "the surface encloses no volume; the outside of a solid is needed, not a sheet");
}

TEST_CASE("a surface wound inward is turned over, and points of its own for every triangle are merged") {
  const TriangleSurface box = test::box_surface({1, 1, 1}, {2, 2, 2});
  TriangleSurface inward = box, soup;
  for (std::size_t t = 0; t < box.triangles.size(); t += 3)
    std::swap(inward.triangles[t], inward.triangles[t + 1]);
  for (const Index n : box.triangles) {
    soup.triangles.push_back(static_cast<Index>(soup.points.size()));
    soup.points.push_back(box.points[static_cast<std::size_t>(n)]);
  }
  for (const TriangleSurface& s : {inward, soup}) {
    const Obstacle o = test::mesh_obstacle(s);
    CHECK(distance_value(o, {0.1, 0, 0.2}) == Approx(-0.3));
    CHECK(distance_value(o, {0.1, 0, 0.7}) == Approx(0.2));
  }
}

TEST_CASE("fields that are no distances to a solid are refused with the remedy") {
  const DistanceGrid good = test::value(sampled_distances(test::box_surface({1, 1, 1}), 0.2));
  REQUIRE(field_solid(good));
  const auto why = [](const DistanceGrid& g) {
    const auto made = field_solid(g);
    REQUIRE_FALSE(made);
    return made.error();
  };
  DistanceGrid g = good;
  for (double& v : g.values) v = std::abs(v) + 0.01;
  CHECK(why(g).starts_with("the distance field is nowhere negative"));
  g = good;
  for (double& v : g.values) v -= 0.6;
  CHECK(why(g).starts_with("the distance field is negative on the border of its grid, at point ("));
  g = good;
  for (double& v : g.values) v *= 3;
  CHECK(why(g).starts_with("the distance field rises by 3"));
  g = good;
  g.values[7] = std::nan("");
  CHECK(why(g) == "value 7 of the distance field is not finite; give distances everywhere");
  g = good;
  g.values.pop_back();
  CHECK(why(g).find("values for") != std::string::npos);
  g = good;
  g.spacing.y = 0;
  CHECK(why(g).find("the spacing 0 m along axis 1") != std::string::npos);
  g = good;
  g.count[2] = 2;
  CHECK(why(g).find("give at least 4") != std::string::npos);
  const auto fine = sampled_distances(test::box_surface({1, 1, 1}), 1e-4);
  REQUIRE_FALSE(fine);
  CHECK(fine.error() ==
        "the spacing = 0.0001 m makes a distance field of more than 1e+08 points; take a larger one");
}

TEST_CASE("an obstacle without its solid is refused") {
  for (const ObstacleShape shape : {ObstacleShape::mesh, ObstacleShape::distance_field}) {
    Obstacle o;
    o.shape = shape;
    CHECK(check_obstacle(o).error().find("has no solid; give") != std::string::npos);
  }
  Obstacle o = test::mesh_obstacle(test::box_surface({1, 1, 1}));
  o.rounding = -1;
  CHECK(check_obstacle(o).error() == "the obstacle's rounding = -1 m; it must be zero or positive");
}
