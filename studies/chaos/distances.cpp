#include "studies/chaos/distances.h"

#include <algorithm>
#include <cmath>

namespace isochor::studies {

namespace {

double length(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

Vec3 turned_by(const std::array<double, 4>& q, const Vec3& v) {
  const Vec3 u{q[1], q[2], q[3]}, w = 2 * cross(u, v);
  return v + q[0] * w + cross(u, w);
}
std::array<double, 4> back(const std::array<double, 4>& q) {
  return {q[0], -q[1], -q[2], -q[3]};
}

// Distance to a box in the plane or in space: `d` are the distances beyond its half edges.
double box_distance(std::initializer_list<double> d) {
  double outside = 0, deepest = -HUGE_VAL;
  for (const double v : d) {
    outside += std::max(v, 0.0) * std::max(v, 0.0);
    deepest = std::max(deepest, v);
  }
  return std::sqrt(outside) + std::min(deepest, 0.0);
}

}  // namespace

std::vector<ConvexPlane> planes_of(const TriangleSurface& surface) {
  std::vector<ConvexPlane> planes;
  Vec3 middle{};
  double extent = 0;
  for (const Vec3& p : surface.points) middle += (1.0 / static_cast<double>(surface.points.size())) * p;
  for (const Vec3& p : surface.points) extent = std::max(extent, length(p - middle));
  for (std::size_t k = 0; k + 3 <= surface.triangles.size(); k += 3) {
    const auto p = [&](std::size_t c) {
      return surface.points[static_cast<std::size_t>(surface.triangles[k + c])];
    };
    Vec3 n = cross(p(1) - p(0), p(2) - p(0));
    n = (1 / length(n)) * n;
    if (dot(n, p(0) - middle) < 0) n = -n;
    planes.push_back({n, dot(n, p(0))});
    for (const Vec3& other : surface.points) {
      if (dot(n, other) > planes.back().distance + 1e-9 * extent) return {};
    }
  }
  return planes;
}

std::optional<double> distance_to(const Obstacle& o, double t, const Vec3& x,
                                  std::span<const ConvexPlane> planes) {
  Vec3 point = x;
  if (!o.motion.keys.empty()) {
    const Pose first = o.motion.keys.front(), now = pose_at(o.motion, t);
    point = first.position + turned_by(first.rotation, turned_by(back(now.rotation), x - now.position));
  }
  const Vec3 z = (1 / length(o.axis)) * o.axis;
  Vec3 s = o.side - dot(o.side, z) * z;
  s = (1 / length(s)) * s;
  const Vec3 d = point - o.position;
  const double px = dot(d, s), py = dot(d, cross(z, s)), pz = dot(d, z), round = std::hypot(px, py);
  const double r = o.rounding;
  switch (o.shape) {
    case ObstacleShape::plane:
      return pz;
    case ObstacleShape::sphere:
      return length(d) - o.radius;
    case ObstacleShape::capsule:
      return std::hypot(round, std::max(0.0, std::abs(pz) - 0.5 * o.length)) - o.radius;
    case ObstacleShape::cylinder:
      return box_distance({round - o.radius + r, std::abs(pz) - 0.5 * o.length + r}) - r;
    case ObstacleShape::box:
      return box_distance({std::abs(px) - 0.5 * o.size.x + r, std::abs(py) - 0.5 * o.size.y + r,
                           std::abs(pz) - 0.5 * o.size.z + r}) -
             r;
    case ObstacleShape::mesh:
    case ObstacleShape::distance_field:
      break;
  }
  if (planes.empty()) return {};
  double deepest = -HUGE_VAL;
  for (const ConvexPlane& plane : planes)
    deepest = std::max(deepest, dot(plane.normal, {px, py, pz}) - plane.distance);
  return deepest - r;
}

}  // namespace isochor::studies
