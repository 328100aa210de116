#include "constraints/patch_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "constraints/triangle.h"

namespace isochor {

namespace {

double norm(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

Vec3 direction(const Vec3& v) {
  const double length = norm(v);
  return length > 0 ? (1 / length) * v : Vec3{};
}

void add_outer(Mat3& m, double s, const Vec3& a, const Vec3& b) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m(i, j) += s * a[i] * b[j];
  }
}

Vec3 triangle_normal(const std::array<std::uint8_t, 3>& c, std::span<const Vec3> x) {
  return direction(cross(x[c[1]] - x[c[0]], x[c[2]] - x[c[0]]));
}

// The triangle of the patch on the other side of an edge; the number of triangles where there is none.
std::size_t across(const Patch& patch, std::size_t triangle, std::uint8_t a, std::uint8_t b) {
  std::size_t t = 0;
  for (; t < patch.triangles; ++t) {
    const auto& c = patch.corner[t];
    if (t != triangle && !patch.side[t] && std::find(c.begin(), c.end(), a) != c.end() &&
        std::find(c.begin(), c.end(), b) != c.end())
      break;
  }
  return t;
}

// The plane of a triangle and the foot of the point on it, which need not be within the triangle.
void use_plane(const Vec3& p, std::span<const Vec3> x, const std::array<std::uint8_t, 3>& c,
               PatchPoint& out) {
  const Vec3 u = x[c[1]] - x[c[0]], v = x[c[2]] - x[c[0]], w = p - x[c[0]], area = cross(u, v);
  const double whole = dot(area, area);
  const double second = dot(area, cross(w, v)) / whole, third = dot(area, cross(u, w)) / whole;
  out.at_edge = false;
  out.corner = c;
  out.normal = direction(area);
  out.distance = out.height = dot(w, out.normal);
  out.weight = {};
  out.weight[c[0]] = 1 - second - third;
  out.weight[c[1]] = second;
  out.weight[c[2]] = third;
}

// Without the sides.
PatchPoint nearest_on_surface(const Vec3& p, std::span<const Vec3> x, const Patch& patch) {
  PatchPoint best;
  double square = std::numeric_limits<double>::infinity();
  best.distance = square;
  std::size_t triangle = 0;
  TrianglePoint nearest;
  Vec3 r{};
  for (std::size_t t = 0; t < patch.triangles; ++t) {
    const auto& c = patch.corner[t];
    if (patch.side[t] || cross(x[c[1]] - x[c[0]], x[c[2]] - x[c[0]]) == Vec3{}) continue;
    const TrianglePoint found = nearest_on_triangle(p, x[c[0]], x[c[1]], x[c[2]]);
    Vec3 way = p;
    for (std::size_t k = 0; k < 3; ++k) way -= found.weight[k] * x[c[k]];
    if (!(dot(way, way) < square)) continue;
    square = dot(way, way);
    r = way;
    triangle = t;
    nearest = found;
  }
  if (!std::isfinite(square)) return best;
  const auto& c = patch.corner[triangle];
  const Vec3 n = triangle_normal(c, x);
  if (nearest.edge >= 0) {
    const auto e = static_cast<std::size_t>(nearest.edge);
    const std::size_t other = across(patch, triangle, c[e], c[(e + 1) % 3]);
    if (other < patch.triangles) {
      best.at_edge = true;
      best.corner = {c[e], c[(e + 1) % 3], 0};
      for (std::size_t k = 0; k < 3; ++k) best.weight[c[k]] = nearest.weight[k];
      const Vec3 out = n + triangle_normal(patch.corner[other], x);
      const double length = std::sqrt(square);
      best.distance = best.height = dot(r, out) < 0 ? -length : length;
      // On the surface itself directions from the nearest point are noise.
      const double size = norm(x[c[1]] - x[c[0]]);
      best.normal = length > 1e-10 * size ? (1 / best.distance) * r : direction(out);
      return best;
    }
  }
  use_plane(p, x, c, best);
  return best;
}

}  // namespace

PatchPoint nearest_on_patch(const Vec3& p, std::span<const Vec3> x, const Patch& patch) {
  PatchPoint best = nearest_on_surface(p, x, patch);
  if (!std::isfinite(best.distance)) return best;
  for (std::size_t t = 0; t < patch.triangles; ++t) {
    const auto& c = patch.corner[t];
    if (!patch.side[t] || cross(x[c[1]] - x[c[0]], x[c[2]] - x[c[0]]) == Vec3{}) continue;
    PatchPoint aside;
    use_plane(p, x, c, aside);
    aside.distance -= patch.margin;
    if (aside.distance > best.distance) best = aside;
  }
  return best;
}

void add_patch_curvature(const PatchPoint& point, std::span<const Vec3> x, double factor, bool bending_alone,
                         std::span<const double> coefficient, std::size_t first, Mat3* blocks) {
  const Vec3& n = point.normal;
  const double d = point.height;
  const std::size_t dimensions = point.at_edge ? 1 : 2, count = coefficient.size();
  // Tangents, and the inverse of their metric.
  std::array<Vec3, 2> tangent{}, dual{};
  double inverse[2][2] = {{0, 0}, {0, 0}};
  for (std::size_t a = 0; a < dimensions; ++a) tangent[a] = x[point.corner[a + 1]] - x[point.corner[0]];
  if (dimensions == 1) {
    inverse[0][0] = 1 / dot(tangent[0], tangent[0]);
  } else if (dimensions == 2) {
    const double m00 = dot(tangent[0], tangent[0]), m01 = dot(tangent[0], tangent[1]),
                 m11 = dot(tangent[1], tangent[1]), determinant = m00 * m11 - m01 * m01;
    inverse[0][0] = m11 / determinant;
    inverse[1][1] = m00 / determinant;
    inverse[0][1] = inverse[1][0] = -m01 / determinant;
  }
  for (std::size_t a = 0; a < dimensions; ++a) {
    for (std::size_t b = 0; b < dimensions; ++b) dual[a] += inverse[a][b] * tangent[b];
  }
  Mat3 bending;
  const bool bends =
      point.at_edge && std::abs(d) > 1e-9 * norm(tangent[0]) && !(bending_alone && factor / d < 0);
  if (bends) {
    for (int i = 0; i < 3; ++i) bending(i, i) = factor / d;
    add_outer(bending, -factor / d, n, n);
    for (std::size_t a = 0; a < dimensions; ++a) add_outer(bending, -factor / d, tangent[a], dual[a]);
  }
  // Slope of the weight of a node along tangent a.
  const auto slope = [&](std::size_t a, std::size_t node) -> double {
    if (node < first) return 0;
    const std::size_t k = node - first;
    return (k == point.corner[a + 1] ? 1.0 : 0.0) - (k == point.corner[0] ? 1.0 : 0.0);
  };
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t l = 0; l <= k; ++l) {
      Mat3& block = blocks[k * (k + 1) / 2 + l];
      if (bends) {
        for (std::size_t e = 0; e < 9; ++e) block.m[e] += coefficient[k] * coefficient[l] * bending.m[e];
      }
      if (bending_alone) continue;
      for (std::size_t a = 0; a < dimensions; ++a) {
        const double ek = slope(a, k), el = slope(a, l);
        if (ek != 0) add_outer(block, -factor * ek * coefficient[l], n, dual[a]);
        if (el != 0) add_outer(block, -factor * el * coefficient[k], dual[a], n);
        for (std::size_t b = 0; b < dimensions; ++b) {
          const double both = ek * slope(b, l);
          if (both != 0) add_outer(block, -factor * d * inverse[a][b] * both, n, n);
        }
      }
    }
  }
}

double crossing_time(const std::array<Vec3, 4>& start, const std::array<Vec3, 4>& end) {
  constexpr double never = 2, slack = 1e-9;
  // Six times the volume under the point, a cubic in time.
  const auto corner = [&](std::size_t k, double t) { return start[k] + t * (end[k] - start[k]); };
  const auto height = [&](double t) {
    const Vec3 a = corner(1, t);
    return dot(corner(0, t) - a, cross(corner(2, t) - a, corner(3, t) - a));
  };
  const Vec3 p = start[0] - start[1], u = start[2] - start[1], v = start[3] - start[1];
  const Vec3 dp = end[0] - end[1] - p, du = end[2] - end[1] - u, dv = end[3] - end[1] - v;
  const double c1 = dot(dp, cross(u, v)) + dot(p, cross(du, v)) + dot(p, cross(u, dv));
  const double c2 = dot(dp, cross(du, v)) + dot(dp, cross(u, dv)) + dot(p, cross(du, dv));
  const double c3 = dot(dp, cross(du, dv));
  // Between its turning points the cubic is monotonic.
  std::array<double, 4> knot{0, 1, 1, 1};
  std::size_t knots = 1;
  const double discriminant = c2 * c2 - 3 * c1 * c3;
  if (discriminant > 0) {
    const double q = -(c2 + std::copysign(std::sqrt(discriminant), c2));
    std::array<double, 2> turn{c3 != 0 ? q / (3 * c3) : never, q != 0 ? c1 / q : never};
    std::sort(turn.begin(), turn.end());
    for (const double t : turn) {
      if (t > 0 && t < 1) knot[knots++] = t;
    }
  }
  knot[knots++] = 1;
  for (std::size_t k = 0; k + 1 < knots; ++k) {
    double low = knot[k], high = knot[k + 1];
    if (!(height(low) > 0 && height(high) <= 0)) continue;
    for (int i = 0; i < 60 && high - low > 1e-14; ++i) {
      const double middle = 0.5 * (low + high);
      (height(middle) > 0 ? low : high) = middle;
    }
    const Vec3 a = corner(1, high), b = corner(2, high), c = corner(3, high), y = corner(0, high);
    const Vec3 area = cross(b - a, c - a);
    const double whole = dot(area, area);
    if (!(whole > 0)) continue;
    const double wb = dot(area, cross(y - a, c - a)) / whole, wc = dot(area, cross(b - a, y - a)) / whole;
    if (wb >= -slack && wc >= -slack && wb + wc <= 1 + slack) return high;
  }
  return never;
}

}  // namespace isochor
