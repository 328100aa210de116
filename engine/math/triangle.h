// What of a triangle is nearest to a point.
#pragma once

#include "engine/base/base.h"

namespace isochor {

struct TrianglePoint {
  std::array<double, 3> weight{};  // of the corners; exactly zero off the feature
  int corner = -1, edge = -1;      // both -1: the face; edge k runs from corner k to the next
};

// Ericson's regions of a triangle (Real-Time Collision Detection 2005, 5.1.5).
inline TrianglePoint nearest_on_triangle(const Vec3& y, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  const double d1 = dot(ab, y - a), d2 = dot(ac, y - a);
  if (d1 <= 0 && d2 <= 0) return {{1, 0, 0}, 0, -1};
  const double d3 = dot(ab, y - b), d4 = dot(ac, y - b);
  if (d3 >= 0 && d4 <= d3) return {{0, 1, 0}, 1, -1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double t = d1 / (d1 - d3);
    return {{1 - t, t, 0}, -1, 0};
  }
  const double d5 = dot(ab, y - c), d6 = dot(ac, y - c);
  if (d6 >= 0 && d5 <= d6) return {{0, 0, 1}, 2, -1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double t = d2 / (d2 - d6);
    return {{1 - t, 0, t}, -1, 2};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {{0, 1 - t, t}, -1, 1};
  }
  const double sum = va + vb + vc;
  return {{va / sum, vb / sum, vc / sum}, -1, -1};
}

}  // namespace isochor
