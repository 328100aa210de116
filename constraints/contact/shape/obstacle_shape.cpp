#include "constraints/contact/shape/obstacle_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/text.h"

namespace isochor {

namespace {

Mat3 columns(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {{a.x, b.x, c.x, a.y, b.y, c.y, a.z, b.z, c.z}};
}

// Around a segment along z from -half to half; a sphere is half = 0.
Distance round(const Vec3& y, double half, double radius) {
  const double nearest = std::clamp(y.z, -half, half);
  const Vec3 d{y.x, y.y, y.z - nearest};
  const double length = norm(d);
  Distance out;
  out.value = length - radius;
  // In the very middle no direction is better than another.
  out.normal = length > 0 ? (1 / length) * d : Vec3{1, 0, 0};
  if (length == 0) return out;
  for (int i = 0; i < 3; ++i) out.curvature(i, i) = 1 / length;
  add_outer(out.curvature, -1 / length, out.normal, out.normal);
  if (std::abs(y.z) < half) add_outer(out.curvature, -1 / length, {0, 0, 1}, {0, 0, 1});
  return out;
}

// From the excess q_k of coordinates over the half sizes of the core, each with its outward direction d_k:
// beyond one face, one edge or one corner, or inside, where the nearest face counts. Straight coordinates
// only.
Distance beyond(const double* q, const Vec3* d, int n, double rounding) {
  Distance out;
  Vec3 sum{};
  double square = 0;
  for (int k = 0; k < n; ++k) {
    if (q[k] <= 0) continue;
    square += q[k] * q[k];
    sum += q[k] * d[k];
  }
  const double length = std::sqrt(square);
  if (length == 0) {
    const int k = static_cast<int>(std::max_element(q, q + n) - q);
    out.value = q[k] - rounding;
    out.normal = d[k];
    return out;
  }
  out.value = length - rounding;
  out.normal = (1 / length) * sum;
  for (int k = 0; k < n; ++k) {
    if (q[k] > 0) add_outer(out.curvature, 1 / length, d[k], d[k]);
  }
  add_outer(out.curvature, -1 / length, out.normal, out.normal);
  return out;
}

double sign(double v) {
  return v < 0 ? -1 : 1;
}

Distance to_cylinder(const Obstacle& s, const Vec3& y) {
  const double r = std::sqrt(y.x * y.x + y.y * y.y);
  const Vec3 radial = r > 0 ? Vec3{y.x / r, y.y / r, 0} : Vec3{1, 0, 0};
  const double q[2] = {r - (s.radius - s.rounding), std::abs(y.z) - (0.5 * s.length - s.rounding)};
  const Vec3 d[2] = {radial, {0, 0, sign(y.z)}};
  Distance out = beyond(q, d, 2, s.rounding);
  // The radial direction turns with the point.
  const double along = dot(out.normal, radial);
  if (along != 0 && r > 0) {
    const Vec3 around = cross({0, 0, 1}, radial);
    add_outer(out.curvature, along / r, around, around);
  }
  return out;
}

Distance to_box(const Obstacle& s, const Vec3& y) {
  double q[3];
  Vec3 d[3];
  for (int k = 0; k < 3; ++k) {
    q[k] = std::abs(y[k]) - (0.5 * s.size[k] - s.rounding);
    d[k][k] = sign(y[k]);
  }
  return beyond(q, d, 3, s.rounding);
}

}  // namespace

ObstaclePose pose_of(const Obstacle& o, const PoseTrack& track, double t) {
  const Vec3 z = (1 / norm(o.axis)) * o.axis;
  Vec3 x = o.side - dot(o.side, z) * z;
  if (dot(x, x) < 1e-12 * dot(o.side, o.side)) {
    // Only shapes that turn about their axis get here.
    x = std::abs(z.x) < 0.7 ? Vec3{1, 0, 0} - z.x * z : Vec3{0, 1, 0} - z.y * z;
  }
  x = (1 / norm(x)) * x;
  ObstaclePose pose{o.position, columns(x, cross(z, x), z)};
  if (track.keys.empty()) return pose;
  const Vec3 origin = carried(track, t, {0, 0, 0});
  const Mat3 turn = columns(carried(track, t, {1, 0, 0}) - origin, carried(track, t, {0, 1, 0}) - origin,
                            carried(track, t, {0, 0, 1}) - origin);
  pose.position = carried(track, t, o.position);
  pose.R = columns(turn * x, turn * cross(z, x), turn * z);
  return pose;
}

Distance distance_to(const Obstacle& s, const Vec3& y) {
  switch (s.shape) {
    case ObstacleShape::plane:
      break;
    case ObstacleShape::sphere:
      return round(y, 0, s.radius);
    case ObstacleShape::capsule:
      return round(y, 0.5 * s.length, s.radius);
    case ObstacleShape::cylinder:
      return to_cylinder(s, y);
    case ObstacleShape::box:
      return to_box(s, y);
    case ObstacleShape::mesh:
    case ObstacleShape::distance_field: {
      Distance out = s.solid->distance(y);
      out.value -= s.rounding;
      return out;
    }
  }
  Distance out;
  out.value = y.z;
  out.normal = {0, 0, 1};
  return out;
}

bool is_solid(const Obstacle& s) {
  return s.shape == ObstacleShape::mesh || s.shape == ObstacleShape::distance_field;
}

bool is_convex(const Obstacle& s) {
  return !is_solid(s);
}

double distance_value(const Obstacle& s, const Vec3& y) {
  return is_solid(s) ? s.solid->value(y) - s.rounding : distance_to(s, y).value;
}

double smallest_extent(const Obstacle& s) {
  switch (s.shape) {
    case ObstacleShape::plane:
      break;
    case ObstacleShape::sphere:
    case ObstacleShape::capsule:
      return 2 * s.radius;
    case ObstacleShape::cylinder:
      return std::min(2 * s.radius, s.length);
    case ObstacleShape::box:
      return std::min({s.size.x, s.size.y, s.size.z});
    case ObstacleShape::mesh:
    case ObstacleShape::distance_field: {
      const auto [low, high] = s.solid->box();
      return std::min({high.x - low.x, high.y - low.y, high.z - low.z});
    }
  }
  return std::numeric_limits<double>::infinity();
}

bool passes_through(const Obstacle& s, const Vec3& y0, const Vec3& y1, Vec3& met) {
  if (s.shape == ObstacleShape::plane) return false;
  const Vec3 way = y1 - y0;
  if (distance_value(s, y0) > norm(way)) return false;
  if (is_solid(s)) return passes_through_solid(*s.solid, y0, y1, met);
  // The distance along a line is convex: halving finds where it is least.
  double low = 0, high = 1;
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high);
    (dot(distance_to(s, y0 + middle * way).normal, way) < 0 ? low : high) = middle;
  }
  const double deepest = 0.5 * (low + high);
  constexpr double deep = 0.25, same_side = 0.5;  // of the smallest extent; cosine between the normals
  if (distance_value(s, y0 + deepest * way) > -deep * smallest_extent(s)) return false;
  low = 0;
  high = deepest;
  if (distance_value(s, y0) > 0) {
    for (int k = 0; k < 50; ++k) {
      const double middle = 0.5 * (low + high);
      (distance_value(s, y0 + middle * way) > 0 ? low : high) = middle;
    }
  }
  met = y0 + low * way;
  return dot(distance_to(s, met).normal, distance_to(s, y1).normal) < same_side;
}

namespace {

Result<void> check_solid(const Obstacle& o) {
  const std::string kind = o.shape == ObstacleShape::mesh ? "mesh" : "distance field";
  if (!o.solid) {
    return Error{"the obstacle is a " + kind + " but has no solid; " +
                 (o.shape == ObstacleShape::mesh
                      ? "give a surface: file in a scene file, solid = mesh_solid(...) in a program"
                      : "give distances: file in a scene file, solid = field_solid(...) in a program")};
  }
  if (!(o.rounding >= 0) || !std::isfinite(o.rounding)) {
    return Error{"the obstacle's rounding = " + number(o.rounding) + " m; it must be zero or positive"};
  }
  return {};
}

}  // namespace

Result<void> check_obstacle(const Obstacle& o) {
  const auto size = [](double v) { return v > 0 && std::isfinite(v); };
  const bool round_shape = o.shape == ObstacleShape::sphere || o.shape == ObstacleShape::capsule ||
                           o.shape == ObstacleShape::cylinder;
  if (!std::isfinite(dot(o.position, o.position))) {
    return Error{"the obstacle's position has a coordinate that is no finite number"};
  }
  if (!size(dot(o.axis, o.axis)) || !size(dot(o.side, o.side))) {
    return Error{"the obstacle's axis and side must be finite directions, not zero"};
  }
  if (round_shape && !size(o.radius)) {
    return Error{"the obstacle's radius = " + number(o.radius) + " m; give a positive one"};
  }
  if ((o.shape == ObstacleShape::capsule || o.shape == ObstacleShape::cylinder) && !size(o.length)) {
    return Error{"the obstacle's length = " + number(o.length) + " m; give a positive one"};
  }
  if (o.shape == ObstacleShape::box) {
    for (int k = 0; k < 3; ++k) {
      if (!size(o.size[k])) {
        return Error{"the obstacle's size[" + std::to_string(k) + "] = " + number(o.size[k]) +
                     " m; give three positive edges"};
      }
    }
    const Vec3 c = cross(o.axis, o.side);
    if (dot(c, c) < 1e-12 * dot(o.axis, o.axis) * dot(o.side, o.side)) {
      return Error{"the obstacle's axis and side are parallel; a box needs two directions to stand by"};
    }
  }
  if (is_solid(o)) {
    if (auto r = check_solid(o); !r) return r;
  }
  const bool edges = o.shape == ObstacleShape::box || o.shape == ObstacleShape::cylinder;
  const double most = edges ? 0.5 * smallest_extent(o) : 0;
  if (!is_solid(o) && (!(o.rounding >= 0) || o.rounding > most || (edges && o.rounding == most))) {
    return Error{"the obstacle's rounding = " + number(o.rounding) + " m; " +
                 (edges ? "it must be less than half its smallest extent, " + number(most) + " m"
                        : "only the edges of cylinders and boxes are rounded, leave it at 0")};
  }
  if (!o.motion.keys.empty()) {
    if (auto r = check_poses(o.motion); !r) return Error{"the obstacle's motion: " + r.error()};
  }
  return {};
}

}  // namespace isochor
