// Distances to patches of moving triangles, and when a point goes through one.
#include <cmath>
#include <random>

#include "constraints/contact/surface/contact_surface.h"
#include "constraints/contact/surface/patch_distance.h"
#include "engine/math/triangle.h"
#include "support/worlds.h"

namespace {

using namespace isochor;

// A triangle with a neighbor across every edge, corners counterclockwise from above.
constexpr std::array<Vec3, 6> kCorner{
    {{0, 0, 0}, {1, 0, 0}, {0.4, 0.9, 0}, {0.5, -0.8, 0}, {1.3, 0.8, 0}, {-0.6, 0.6, 0}}};
Patch full_patch() {
  Patch p;
  p.corner = {{{0, 1, 2}, {1, 0, 3}, {2, 1, 4}, {0, 2, 5}}};
  p.triangles = 4;
  p.nodes = 6;
  return p;
}

struct Sample {
  Vec3 point;
  std::array<Vec3, 6> corner;
};

// A ridge or a valley (by the sign of `fold`), with a little disorder.
Sample sample(double fold, const Vec3& point, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> noise(-0.05, 0.05);
  Sample s{point, kCorner};
  for (std::size_t k = 0; k < 6; ++k) {
    for (int i = 0; i < 3; ++i) s.corner[k][i] += noise(random);
    if (k > 2) s.corner[k].z += fold;
  }
  return s;
}

// Node 0 is the point, 1 to 6 the corners.
Vec3& node(Sample& s, std::size_t k) {
  return k == 0 ? s.point : s.corner[k - 1];
}

std::array<Vec3, 7> gradient(const Sample& s) {
  const PatchPoint p = nearest_on_patch(s.point, s.corner, full_patch());
  std::array<Vec3, 7> g{};
  g[0] = p.normal;
  for (std::size_t k = 0; k < 6; ++k) g[k + 1] = -p.weight[k] * p.normal;
  return g;
}

}  // namespace

TEST_CASE(
    "distances to a patch: gradient and curvature against differences, at faces, edges and beyond the "
    "border") {
  struct Place {
    double fold;
    Vec3 point;
    bool at_edge;
  };
  // Within a triangle, over a ridge, in a valley, and beyond the border of the patch.
  const Place places[] = {{-0.5, {0.45, 0.3, 0.4}, false},  {-0.5, {0.45, 0.3, -0.05}, false},
                          {0.5, {0.45, 0.3, 0.1}, false},   {-0.9, {0.5, -0.15, 0.3}, true},
                          {-0.9, {0.85, 0.55, 0.3}, true},  {0.9, {0.5, -0.1, -0.4}, true},
                          {-0.9, {-0.4, -0.5, 0.3}, false}, {0.1, {1.6, 1.2, -0.2}, false}};
  for (const Place& place : places) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      Sample s = sample(place.fold, place.point, seed);
      const PatchPoint p = nearest_on_patch(s.point, s.corner, full_patch());
      INFO("fold " << place.fold << ", seed " << seed << ", at an edge " << (p.dimensions == 1));
      CHECK((p.dimensions == 1) == place.at_edge);
      const auto g = gradient(s);
      std::array<double, 7> coefficient{1};
      for (std::size_t k = 0; k < 6; ++k) coefficient[k + 1] = -p.weight[k];
      std::array<Mat3, 28> blocks{};
      constexpr double factor = -1.7;
      add_patch_curvature(p, factor, false, coefficient, 1, blocks.data());
      const double h = 1e-6;
      double worst_gradient = 0, worst_curvature = 0;
      for (std::size_t l = 0; l < 7; ++l) {
        for (int j = 0; j < 3; ++j) {
          Sample up = s, down = s;
          node(up, l)[j] += h;
          node(down, l)[j] -= h;
          const double slope = (nearest_on_patch(up.point, up.corner, full_patch()).distance -
                                nearest_on_patch(down.point, down.corner, full_patch()).distance) /
                               (2 * h);
          worst_gradient = std::max(worst_gradient, std::abs(slope - g[l][j]));
          const auto above = gradient(up), below = gradient(down);
          for (std::size_t k = 0; k < 7; ++k) {
            for (int i = 0; i < 3; ++i) {
              const double expected = factor * (above[k][i] - below[k][i]) / (2 * h);
              const double found =
                  k >= l ? blocks[k * (k + 1) / 2 + l](i, j) : blocks[l * (l + 1) / 2 + k](j, i);
              worst_curvature = std::max(worst_curvature, std::abs(found - expected));
            }
          }
        }
      }
      CHECK(worst_gradient < 1e-8);
      CHECK(worst_curvature < 1e-6);
    }
  }
}

TEST_CASE("distances to faces of four and six nodes: gradient and curvature against differences") {
  for (const std::size_t nodes : {std::size_t{4}, std::size_t{6}}) {
    Patch patch;
    patch.face = patch.nodes = static_cast<std::uint8_t>(nodes);
    patch.triangles = 1;
    patch.corner[0] =
        nodes == 4 ? std::array<std::uint8_t, 3>{0, 1, 2} : std::array<std::uint8_t, 3>{3, 4, 5};
    for (unsigned seed = 0; seed < 6; ++seed) {
      std::mt19937 random(seed);
      std::uniform_real_distribution<double> noise(-0.12, 0.12);
      std::array<Vec3, 7> y{};
      y[0] = {0.45 + noise(random), 0.3 + noise(random), seed % 2 == 0 ? 0.15 : -0.2};
      for (std::size_t k = 0; k < nodes; ++k) {
        const auto uv = face_place(nodes, k);
        y[k + 1] = {uv[0] + noise(random), uv[1] + noise(random), noise(random)};
      }
      const auto at_place = [&](const std::array<Vec3, 7>& z) {
        return nearest_on_patch(z[0], std::span(z).subspan(1, nodes), patch);
      };
      const auto slope_at = [&](const std::array<Vec3, 7>& z, std::size_t k) {
        const PatchPoint p = at_place(z);
        return (k == 0 ? 1.0 : -p.weight[k - 1]) * p.normal;
      };
      const PatchPoint p = at_place(y);
      INFO(nodes << " nodes, seed " << seed);
      CHECK((p.bend[0] != 0 || p.bend[1] != 0));
      CHECK((p.distance > 0) == (seed % 2 == 0));
      std::array<double, 7> coefficient{1};
      for (std::size_t k = 0; k < nodes; ++k) coefficient[k + 1] = -p.weight[k];
      std::array<Mat3, 28> blocks{};
      add_patch_curvature(p, 2.3, false, std::span(coefficient).first(nodes + 1), 1, blocks.data());
      double worst_gradient = 0, worst_curvature = 0;
      const double h = 1e-6;
      for (std::size_t l = 0; l <= nodes; ++l) {
        for (int j = 0; j < 3; ++j) {
          auto up = y, down = y;
          up[l][j] += h;
          down[l][j] -= h;
          const double slope = (at_place(up).distance - at_place(down).distance) / (2 * h);
          worst_gradient = std::max(worst_gradient, std::abs(slope - slope_at(y, l)[j]));
          for (std::size_t k = 0; k <= nodes; ++k) {
            for (int i = 0; i < 3; ++i) {
              const double expected = 2.3 * (slope_at(up, k)[i] - slope_at(down, k)[i]) / (2 * h);
              const double found =
                  k >= l ? blocks[k * (k + 1) / 2 + l](i, j) : blocks[l * (l + 1) / 2 + k](j, i);
              worst_curvature = std::max(worst_curvature, std::abs(found - expected));
            }
          }
        }
      }
      CHECK(worst_gradient < 1e-8);
      CHECK(worst_curvature < 1e-6);
    }
  }
}

TEST_CASE("distances to a patch have the sign of the side, and none to a patch without area") {
  // Beyond a ridge the nearest place is on it, in a valley behind it too.
  CHECK(nearest_on_patch({0.5, -0.1, 0.4}, sample(-0.9, {}, 1).corner, full_patch()).distance > 0);
  CHECK(nearest_on_patch({0.45, 0.2, -0.3}, sample(-0.9, {}, 1).corner, full_patch()).distance < 0);
  CHECK(nearest_on_patch({0.5, 0.1, -0.6}, sample(0.9, {}, 1).corner, full_patch()).distance < 0);
  const std::array<Vec3, 6> flat{};
  CHECK(std::isinf(nearest_on_patch({1, 2, 3}, flat, full_patch()).distance));
}

TEST_CASE("a point goes through a moving triangle from the front when it does") {
  const std::array<Vec3, 3> t{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  const auto time = [&](const Vec3& p0, const Vec3& p1, const Vec3& shift) {
    return crossing_time({p0, t[0], t[1], t[2]}, {p1, t[0] + shift, t[1] + shift, t[2] + shift});
  };
  CHECK(time({0.2, 0.2, 1}, {0.2, 0.2, -3}, {}) == Approx(0.25));
  CHECK(time({0.2, 0.2, 1}, {0.2, 0.2, 1}, {0, 0, 4}) == Approx(0.25));
  CHECK(time({0.2, 0.2, 0.5}, {0.2, 0.2, -100}, {0, 0, 1}) == Approx(0.5 / 101.5));
  CHECK(time({0.2, 0.2, -1}, {0.2, 0.2, 3}, {}) > 1);   // from behind
  CHECK(time({0.2, 0.2, 1}, {0.2, 0.2, 0.1}, {}) > 1);  // stays in front
  CHECK(time({0.8, 0.8, 1}, {0.8, 0.8, -1}, {}) > 1);   // beside it
  CHECK(time({0.8, 0.8, 1}, {-0.2, -0.2, -1}, {}) == Approx(0.5));
  // There and back within the way: a triangle that swings through a point at rest.
  const double c = crossing_time({Vec3{0.2, 0.2, 0.1}, t[0], t[1], t[2]},
                                 {Vec3{0.2, 0.2, 0.1}, {0, 0, 1}, {1, 0, -0.5}, {0, 1, -0.5}});
  CHECK(c <= 1);
}

TEST_CASE("points of a surface stand for its area, and integrate cubics over it") {
  std::vector<Vec3> x{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}};
  const ContactSurface surface({SurfaceFaces{{0, 1, 2, 0, 2, 3}, 3}, {}}, x);
  double area = 0, cubic = 0;
  for (const SurfacePoint& p : surface.points()) {
    const Vec3 q = p.position(x);
    area += p.area;
    cubic += p.area * q.x * q.x * q.y;
  }
  CHECK(area == Approx(2.0));
  CHECK(cubic == Approx(8.0 / 3 * 0.5));
  CHECK(surface.points().size() == 4 + 5 + 2);
  // Folded at a right angle, the corners and the middle of the edge between the two belong to both.
  x[3] = {1, 0.5, 2};
  CHECK(ContactSurface({SurfaceFaces{{0, 1, 2, 0, 2, 3}, 3}, {}}, x).points().size() == 4 + 5 + 2 + 3);
}

TEST_CASE("the search finds what brute force finds") {
  BoxMeshDef def;
  def.divisions = {4, 4, 3};
  const Mesh lower = test::value(box_mesh(def));
  std::vector<Vec3> x = lower.nodes;
  const auto count = static_cast<Index>(x.size());
  std::array<SurfaceFaces, 2> sides;
  for (const auto& surface : lower.surfaces) {
    for (std::size_t f = 0; f < surface.faces.size(); f += 3) {
      std::array<Index, 3> c{surface.faces[f], surface.faces[f + 1], surface.faces[f + 2]};
      const Vec3 a = x[at(c[0])], n = cross(x[at(c[1])] - a, x[at(c[2])] - a);
      if (dot(n, a - Vec3{0.5, 0.5, 0.5}) < 0) std::swap(c[1], c[2]);
      for (const Index i : c) {
        sides[0].faces.push_back(i);
        sides[1].faces.push_back(i + count);
      }
    }
  }
  for (Index i = 0; i < count; ++i) x.push_back(x[static_cast<std::size_t>(i)] + Vec3{0.13, 0.07, 1.02});
  const ContactSurface surface(sides, x);
  std::vector<Vec3> moved = x;
  for (std::size_t i = static_cast<std::size_t>(count); i < x.size(); ++i)
    moved[i] += Vec3{0.01 * std::sin(9 * moved[i].x), 0, -0.05 + 0.01 * std::cos(7 * moved[i].y)};
  std::vector<ContactSurface::Finding> found(surface.points().size());
  const double reach = 0.2;
  const std::vector<Index> none(found.size(), -1);
  surface.search(x, moved, reach, none, nullptr, found);
  Index near = 0, crossed = 0;
  for (Index s = 0; s < static_cast<Index>(found.size()); ++s) {
    double best = reach;
    double earliest = 2;
    const SurfacePoint& p = surface.points()[at(s)];
    const Vec3 p0 = p.position(x), p1 = p.position(moved);
    for (Index t = 0; t < surface.triangles(); ++t) {
      if ((t < surface.triangles() / 2 ? 0 : 1) == p.side || !surface.facing(s, t, moved)) continue;
      const auto& c = surface.corners(t);
      const std::array<Vec3, 3> now{moved[at(c[0])], moved[at(c[1])], moved[at(c[2])]};
      const TrianglePoint place = nearest_on_triangle(p1, now[0], now[1], now[2]);
      const Vec3 r = p1 - (place.weight[0] * now[0] + place.weight[1] * now[1] + place.weight[2] * now[2]);
      best = std::min(best, std::sqrt(dot(r, r)));
      earliest = std::min(
          earliest, crossing_time({p0, x[at(c[0])], x[at(c[1])], x[at(c[2])]}, {p1, now[0], now[1], now[2]}));
    }
    // What lies beside the other body has nothing below it.
    const bool beside = best < reach && found[at(s)].nearest < 0;
    INFO("point " << p1.x << " " << p1.y << " " << p1.z << " of side " << p.side);
    if (beside) CHECK((p1.x < 0.15 || p1.x > 0.98 || p1.y < 0.09 || p1.y > 0.98));
    CHECK((found[at(s)].nearest >= 0) <= (best < reach));
    const bool inside = p1.x > 0.15 && p1.x < 0.98 && p1.y > 0.09 && p1.y < 0.98;
    if (found[at(s)].nearest >= 0 && inside) CHECK(std::abs(found[at(s)].distance) == Approx(best));
    CHECK((found[at(s)].crossed >= 0) == (earliest <= 1));
    near += found[at(s)].nearest >= 0 ? 1 : 0;
    crossed += found[at(s)].crossed >= 0 ? 1 : 0;
  }
  CHECK(near > 50);
  CHECK(crossed > 20);
}
