// Rotations as unit quaternions w, x, y, z.
#pragma once

#include <array>
#include <cmath>

#include "isochor/types.h"

namespace isochor::live {

using Quaternion = std::array<double, 4>;

// A turn about a unit vector [rad].
inline Quaternion quaternion(const Vec3& axis, double angle) {
  const double s = std::sin(0.5 * angle);
  return {std::cos(0.5 * angle), s * axis.x, s * axis.y, s * axis.z};
}

// Of a turn vector: axis times angle [rad].
inline Quaternion quaternion(const Vec3& turn) {
  const double angle = std::sqrt(dot(turn, turn));
  return angle > 0 ? quaternion((1 / angle) * turn, angle) : Quaternion{1, 0, 0, 0};
}

inline Vec3 turned(const Quaternion& q, const Vec3& v) {
  const Vec3 u{q[1], q[2], q[3]};
  const Vec3 t = 2.0 * cross(u, v);
  return v + q[0] * t + cross(u, t);
}

// First b, then a.
inline Quaternion product(const Quaternion& a, const Quaternion& b) {
  const Vec3 u{a[1], a[2], a[3]}, v{b[1], b[2], b[3]};
  const Vec3 w = a[0] * v + b[0] * u + cross(u, v);
  return {a[0] * b[0] - dot(u, v), w.x, w.y, w.z};
}

inline Quaternion inverse(const Quaternion& q) {
  return {q[0], -q[1], -q[2], -q[3]};
}

// Axis times angle, the shorter way round [rad].
inline Vec3 turn_of(const Quaternion& q) {
  const Vec3 v = q[0] < 0 ? Vec3{-q[1], -q[2], -q[3]} : Vec3{q[1], q[2], q[3]};
  const double s = std::sqrt(dot(v, v));
  return s > 0 ? (2 * std::atan2(s, std::abs(q[0])) / s) * v : Vec3{};
}

}  // namespace isochor::live
