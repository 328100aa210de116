// Where a rigid shape is: a given pose, or four points of a free rigid body that are unknowns.
#pragma once

#include "constraints/contact/shape/obstacle_shape.h"

namespace isochor {

// Four points of a rigid body, a quarter of its mass each, so placed that lumped masses have its inertia: at
// (+,+,+), (+,-,-), (-,+,-), (-,-,+) times the radii of inertia along its principal axes. Any point of the
// body is an affine combination of them.
struct ControlPoints {
  std::array<Index, 4> node{};
  Vec3 radius{};  // sqrt(integral of y_k^2 dm / m) [m]

  Vec3 own(std::size_t a) const {
    constexpr double sign[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    return {sign[a][0] * radius.x, sign[a][1] * radius.y, sign[a][2] * radius.z};
  }
  // Gradient of the weight of point a in the body's own coordinates [1/m].
  Vec3 slope(std::size_t a) const {
    const Vec3 y = own(a);
    return {0.25 * y.x / (radius.x * radius.x), 0.25 * y.y / (radius.y * radius.y),
            0.25 * y.z / (radius.z * radius.z)};
  }
  double weight(std::size_t a, const Vec3& y) const { return 0.25 + dot(slope(a), y); }
};

// x = c + A y; A is a rotation, or close to one while the rows of a free body are being met.
struct ContactFrame {
  Vec3 c{};
  Mat3 A, inverse;

  Vec3 to_own(const Vec3& x) const { return inverse * (x - c); }
  Vec3 to_world(const Vec3& y) const { return c + A * y; }
};
ContactFrame frame_of(const ObstaclePose& pose);
inline bool same_pose(const ContactFrame& a, const ContactFrame& b) {
  return a.c == b.c && a.A.m == b.A.m;
}
ContactFrame frame_of(const ControlPoints& points, std::span<const Vec3> x);

// What else free rigid bodies share with the contacts that name them.
struct RigidShape {
  Obstacle shape;  // its own axes are the principal axes
  ControlPoints points;
};

}  // namespace isochor
