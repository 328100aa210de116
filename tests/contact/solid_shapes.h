// Closed surfaces for tests of solids.
#pragma once

#include <cmath>
#include <map>

#include "catch.h"
#include "engine/mesh/boundary.h"
#include "isochor/contact.h"
#include "support/worlds.h"

namespace test {

using isochor::TriangleSurface;

// A sphere of triangles: an octahedron whose triangles are quartered `levels` times.
inline TriangleSurface ball_surface(double radius, int levels) {
  TriangleSurface s;
  s.points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  s.triangles = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  const auto unit = [](const Vec3& p) { return (1 / std::sqrt(dot(p, p))) * p; };
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<Index, Index>, Index> middle;
    const auto between = [&](Index a, Index b) {
      const auto [it, fresh] = middle.try_emplace(std::minmax(a, b), static_cast<Index>(s.points.size()));
      const Vec3 sum = s.points[static_cast<std::size_t>(a)] + s.points[static_cast<std::size_t>(b)];
      if (fresh) s.points.push_back(unit(sum));
      return it->second;
    };
    std::vector<Index> finer;
    for (std::size_t t = 0; t < s.triangles.size(); t += 3) {
      const Index a = s.triangles[t], b = s.triangles[t + 1], c = s.triangles[t + 2];
      const Index ab = between(a, b), bc = between(b, c), ca = between(c, a);
      finer.insert(finer.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
    }
    s.triangles = finer;
  }
  for (Vec3& p : s.points) p = radius * p;
  return s;
}

// The boundary of a box of cells about the origin.
inline TriangleSurface box_surface(const Vec3& size, std::array<int, 3> divisions = {3, 2, 4}) {
  TriangleSurface s = isochor::boundary_of(box(divisions, size));
  for (Vec3& p : s.points) p -= 0.5 * size;
  return s;
}

// A block with a trough along y: walls at x = 0 to 0.2 and 0.8 to 1, ground at z = 0 to 0.2.
inline TriangleSurface trough_surface() {
  const Mesh block = box({5, 1, 5}, {1, 1, 1});
  return isochor::boundary_of(without_cells(block, {0.2, -1, 0.2}, {0.8, 2, 2}, "trough"));
}

// A block of unit edges with a round hollow of this radius in its top, about (0.5, 0.5, 1).
inline TriangleSurface bowl_surface(double radius) {
  constexpr int n = 24;
  TriangleSurface s = isochor::boundary_of(box({n, n, 4}, {1, 1, 1}));
  for (Vec3& p : s.points) {
    if (p.z < 1 - 1e-9) continue;
    const double r2 = (p.x - 0.5) * (p.x - 0.5) + (p.y - 0.5) * (p.y - 0.5);
    // Sinks by the bowl around the middle of the top.
    const double deep = std::sqrt(std::max(radius * radius - r2, 0.0)) - std::sqrt(radius * radius - 0.16);
    p.z -= std::max(deep, 0.0);
  }
  return s;
}

inline isochor::Obstacle solid_obstacle(isochor::ObstacleShape shape, isochor::SolidPtr solid) {
  isochor::Obstacle o;
  o.shape = shape;
  o.solid = std::move(solid);
  return o;
}
inline isochor::Obstacle mesh_obstacle(const TriangleSurface& s) {
  return solid_obstacle(isochor::ObstacleShape::mesh, value(isochor::mesh_solid(s)));
}
inline isochor::Obstacle field_obstacle(const TriangleSurface& s, double spacing) {
  return solid_obstacle(isochor::ObstacleShape::distance_field,
                        value(isochor::field_solid(value(isochor::sampled_distances(s, spacing)))));
}

}  // namespace test
