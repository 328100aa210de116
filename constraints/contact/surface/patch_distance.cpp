#include "constraints/contact/surface/patch_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "constraints/contact/surface/crossing.h"
#include "engine/math/triangle.h"

namespace isochor {

namespace {

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
PatchPoint on_plane(const Vec3& p, std::span<const Vec3> x, const std::array<std::uint8_t, 3>& c) {
  const Vec3 u = x[c[1]] - x[c[0]], v = x[c[2]] - x[c[0]], w = p - x[c[0]], area = cross(u, v);
  const double whole = dot(area, area);
  const double second = dot(area, cross(w, v)) / whole, third = dot(area, cross(u, w)) / whole;
  PatchPoint out;
  out.normal = direction(area);
  out.distance = out.height = dot(w, out.normal);
  out.weight[c[0]] = 1 - second - third;
  out.weight[c[1]] = second;
  out.weight[c[2]] = third;
  out.tangent = {u, v};
  for (std::size_t a = 0; a < 2; ++a) {
    out.slope[a][c[0]] = -1;
    out.slope[a][c[a + 1]] = 1;
  }
  return out;
}

// The edge between two triangles, `out` along the sum of their normals.
PatchPoint on_edge(const Vec3& r, std::span<const Vec3> x, std::uint8_t a, std::uint8_t b, double t,
                   const Vec3& out) {
  PatchPoint found;
  found.dimensions = 1;
  found.weight[a] = 1 - t;
  found.weight[b] = t;
  found.tangent[0] = x[b] - x[a];
  found.slope[0][a] = -1;
  found.slope[0][b] = 1;
  const double length = norm(r);
  found.distance = found.height = dot(r, out) < 0 ? -length : length;
  // On the surface itself directions from the nearest point are noise.
  found.normal = length > 1e-10 * norm(found.tangent[0]) ? (1 / found.distance) * r : direction(out);
  return found;
}

struct FacePlace {
  Vec3 point{}, u{}, v{}, uu{}, uv{}, vv{};
};

FacePlace place_on(const FaceShape& shape, std::span<const Vec3> x, std::size_t nodes) {
  FacePlace at_place;
  for (std::size_t k = 0; k < nodes; ++k) {
    at_place.point += shape.N[k] * x[k];
    at_place.u += shape.u[k] * x[k];
    at_place.v += shape.v[k] * x[k];
    at_place.uu += shape.uu[k] * x[k];
    at_place.uv += shape.uv[k] * x[k];
    at_place.vv += shape.vv[k] * x[k];
  }
  return at_place;
}

// The foot of the point on a face of four or six nodes, by Newton's method from a place nearby; false where
// it does not settle close to it.
bool on_face(const Vec3& p, std::span<const Vec3> x, std::size_t nodes, std::array<double, 2> start,
             PatchPoint& out) {
  double u = start[0], v = start[1];
  for (int i = 0; i < 25; ++i) {
    const FaceShape shape = face_shape(nodes, u, v);
    const FacePlace f = place_on(shape, x, nodes);
    const Vec3 r = p - f.point;
    const double gu = dot(r, f.u), gv = dot(r, f.v);
    double auu = dot(f.u, f.u) - dot(r, f.uu), auv = dot(f.u, f.v) - dot(r, f.uv),
           avv = dot(f.v, f.v) - dot(r, f.vv), determinant = auu * avv - auv * auv;
    const double metric = dot(f.u, f.u) * dot(f.v, f.v) - dot(f.u, f.v) * dot(f.u, f.v);
    if (!(metric > 0)) return false;
    // Where the distance is not convex, as if the face were flat.
    if (!(auu > 0) || !(determinant > 1e-3 * metric)) {
      auu = dot(f.u, f.u);
      auv = dot(f.u, f.v);
      avv = dot(f.v, f.v);
      determinant = metric;
    }
    const double du = (avv * gu - auv * gv) / determinant, dv = (auu * gv - auv * gu) / determinant;
    u += du;
    v += dv;
    if (std::abs(u - start[0]) > 1 || std::abs(v - start[1]) > 1) return false;
    if (std::abs(du) + std::abs(dv) > 1e-13) continue;
    out = PatchPoint{};
    out.normal = direction(cross(f.u, f.v));
    out.distance = out.height = dot(r, out.normal);
    out.tangent = {f.u, f.v};
    out.bend = {dot(out.normal, f.uu), dot(out.normal, f.uv), dot(out.normal, f.vv)};
    for (std::size_t k = 0; k < nodes; ++k) {
      out.weight[k] = shape.N[k];
      out.slope[0][k] = shape.u[k];
      out.slope[1][k] = shape.v[k];
    }
    return true;
  }
  return false;
}

// Nearest place on a triangle, kept within it.
struct Foot {
  double square = std::numeric_limits<double>::infinity();
  Vec3 r{};
  TrianglePoint place;
};
Foot foot_on(const Vec3& p, std::span<const Vec3> x, const std::array<std::uint8_t, 3>& c) {
  Foot foot;
  if (cross(x[c[1]] - x[c[0]], x[c[2]] - x[c[0]]) == Vec3{}) return foot;
  foot.place = nearest_on_triangle(p, x[c[0]], x[c[1]], x[c[2]]);
  foot.r = p;
  for (std::size_t k = 0; k < 3; ++k) foot.r -= foot.place.weight[k] * x[c[k]];
  foot.square = dot(foot.r, foot.r);
  return foot;
}

// Without the sides.
PatchPoint nearest_on_surface(const Vec3& p, std::span<const Vec3> x, const Patch& patch) {
  PatchPoint best;
  best.distance = std::numeric_limits<double>::infinity();
  Foot foot;
  std::size_t triangle = 0;
  if (patch.face > 3) {
    foot = foot_on(p, x, patch.corner[0]);
    if (!std::isfinite(foot.square)) return best;
    std::array<double, 2> start{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto uv = face_place(patch.face, patch.corner[0][k]);
      for (std::size_t a = 0; a < 2; ++a) start[a] += foot.place.weight[k] * uv[a];
    }
    if (on_face(p, x, patch.face, start, best)) return best;
    return on_plane(p, x, patch.corner[0]);
  }
  for (std::size_t t = 0; t < patch.triangles; ++t) {
    if (patch.side[t]) continue;
    const Foot other = foot_on(p, x, patch.corner[t]);
    if (!(other.square < foot.square)) continue;
    foot = other;
    triangle = t;
  }
  if (!std::isfinite(foot.square)) return best;
  const auto& c = patch.corner[triangle];
  if (foot.place.edge >= 0) {
    const auto e = static_cast<std::size_t>(foot.place.edge);
    const std::size_t other = across(patch, triangle, c[e], c[(e + 1) % 3]);
    if (other < patch.triangles) {
      const Vec3 out = triangle_normal(c, x) + triangle_normal(patch.corner[other], x);
      return on_edge(foot.r, x, c[e], c[(e + 1) % 3], foot.place.weight[(e + 1) % 3], out);
    }
  }
  return on_plane(p, x, c);
}

}  // namespace

PatchPoint nearest_on_patch(const Vec3& p, std::span<const Vec3> x, const Patch& patch) {
  PatchPoint best = nearest_on_surface(p, x, patch);
  if (!std::isfinite(best.distance)) return best;
  for (std::size_t t = 0; t < patch.triangles; ++t) {
    const auto& c = patch.corner[t];
    if (!patch.side[t] || cross(x[c[1]] - x[c[0]], x[c[2]] - x[c[0]]) == Vec3{}) continue;
    PatchPoint aside = on_plane(p, x, c);
    aside.distance -= patch.margin;
    if (aside.distance > best.distance) best = aside;
  }
  return best;
}

namespace {

// Inverse of A, and the dual tangents.
struct PatchFrame {
  std::array<std::array<double, 2>, 2> inverse{};
  std::array<Vec3, 2> dual{};
};
PatchFrame frame_of(const PatchPoint& point) {
  const std::size_t dimensions = point.dimensions;
  PatchFrame frame;
  std::array<std::array<double, 2>, 2> metric{};
  const auto invert = [&](std::array<std::array<double, 2>, 2>& out, double share) {
    double m[2][2];
    for (std::size_t a = 0; a < dimensions; ++a) {
      for (std::size_t b = 0; b < dimensions; ++b)
        m[a][b] = dot(point.tangent[a], point.tangent[b]) - share * point.bend[a + b];
    }
    if (dimensions == 1) {
      out[0][0] = 1 / m[0][0];
      return;
    }
    const double determinant = m[0][0] * m[1][1] - m[0][1] * m[0][1];
    out[0][0] = m[1][1] / determinant;
    out[1][1] = m[0][0] / determinant;
    out[0][1] = out[1][0] = -m[0][1] / determinant;
  };
  invert(metric, 0);
  invert(frame.inverse, point.height);
  for (std::size_t a = 0; a < dimensions; ++a) {
    for (std::size_t b = 0; b < dimensions; ++b) frame.dual[a] += metric[a][b] * point.tangent[b];
  }
  return frame;
}

}  // namespace

PatchRate patch_rate(const PatchPoint& point, double coefficient, std::size_t node) {
  const auto [inverse, dual] = frame_of(point);
  const Vec3& n = point.normal;
  const double d = point.height;
  const std::size_t dimensions = point.dimensions;
  const auto slope = [&](std::size_t a) { return node < kPatchNodes ? point.slope[a][node] : 0.0; };
  PatchRate rate;
  for (std::size_t a = 0; a < dimensions; ++a) {
    for (std::size_t b = 0; b < dimensions; ++b)
      rate.foot[a] += inverse[a][b] * (coefficient * point.tangent[b] + d * slope(b) * n);
  }
  for (std::size_t a = 0; a < dimensions; ++a) {
    Vec3 turn = slope(a) * n;
    for (std::size_t b = 0; b < dimensions; ++b) turn += point.bend[a + b] * rate.foot[b];
    add_outer(rate.normal, -1, dual[a], turn);
  }
  if (dimensions < 2 && std::abs(d) > 1e-9 * norm(point.tangent[0])) {
    for (int i = 0; i < 3; ++i) rate.normal(i, i) += coefficient / d;
    add_outer(rate.normal, -coefficient / d, n, n);
    add_outer(rate.normal, -coefficient / d, point.tangent[0], dual[0]);
  }
  return rate;
}

void add_patch_curvature(const PatchPoint& point, double factor, bool bending,
                         std::span<const double> coefficient, std::size_t first, Mat3* blocks) {
  const Vec3& n = point.normal;
  const double d = point.height;
  const std::size_t dimensions = point.dimensions, count = coefficient.size();
  const auto bend = [&](std::size_t a, std::size_t b) { return point.bend[a + b]; };
  const auto [inverse, dual] = frame_of(point);
  Mat3 about;
  const bool bends =
      dimensions < 2 && std::abs(d) > 1e-9 * norm(point.tangent[0]) && !(bending && factor / d < 0);
  if (bends) {
    for (int i = 0; i < 3; ++i) about(i, i) = factor / d;
    add_outer(about, -factor / d, n, n);
    add_outer(about, -factor / d, point.tangent[0], dual[0]);
  }
  const auto slope = [&](std::size_t a, std::size_t node) {
    return node < first ? 0.0 : point.slope[a][node - first];
  };
  for (std::size_t l = 0; l < count; ++l) {
    // d xi_a / d y_l, and the part of d n / d y_l within the tangents, by dual tangent.
    std::array<Vec3, 2> foot{}, turn{};
    for (std::size_t a = 0; a < dimensions && !bending; ++a) {
      for (std::size_t b = 0; b < dimensions; ++b)
        foot[a] += inverse[a][b] * (coefficient[l] * point.tangent[b] + d * slope(b, l) * n);
    }
    for (std::size_t a = 0; a < dimensions && !bending; ++a) {
      turn[a] = slope(a, l) * n;
      for (std::size_t b = 0; b < dimensions; ++b) turn[a] += bend(a, b) * foot[b];
    }
    for (std::size_t k = l; k < count; ++k) {
      Mat3& block = blocks[k * (k + 1) / 2 + l];
      if (bends) {
        for (std::size_t e = 0; e < 9; ++e) block.m[e] += coefficient[k] * coefficient[l] * about.m[e];
      }
      for (std::size_t a = 0; a < dimensions && !bending; ++a) {
        add_outer(block, -factor * slope(a, k), n, foot[a]);
        add_outer(block, -factor * coefficient[k], dual[a], turn[a]);
      }
    }
  }
}

double crossing_time(const std::array<Vec3, 4>& start, const std::array<Vec3, 4>& end) {
  constexpr double slack = 1e-9;
  return first_crossing(start, end, [&](double t) {
    std::array<Vec3, 4> now;
    for (std::size_t k = 0; k < 4; ++k) now[k] = start[k] + t * (end[k] - start[k]);
    const auto& [y, a, b, c] = now;
    const Vec3 area = cross(b - a, c - a);
    const double whole = dot(area, area);
    if (!(whole > 0)) return false;
    const double wb = dot(area, cross(y - a, c - a)) / whole, wc = dot(area, cross(b - a, y - a)) / whole;
    return wb >= -slack && wc >= -slack && wb + wc <= 1 + slack;
  });
}

}  // namespace isochor
