// Axes that turn with a surface, in which contact keeps the pull of friction from one step to the next.
#pragma once

#include <cmath>

#include "engine/base/base.h"

namespace isochor {

// Columns: along u, beside it, and along `out`, which is across u. Zero where these have no direction.
inline Mat3 turning_axes(const Vec3& u, const Vec3& out) {
  Mat3 m;
  if (!(dot(u, u) > 0) || !(dot(out, out) > 0)) return m;
  const Vec3 e = (1 / std::sqrt(dot(u, u))) * u, up = (1 / std::sqrt(dot(out, out))) * out,
             beside = cross(up, e);
  for (int i = 0; i < 3; ++i) {
    m(i, 0) = e[i];
    m(i, 1) = beside[i];
    m(i, 2) = up[i];
  }
  return m;
}

// Rate of v / |v|.
inline Vec3 direction_rate(const Vec3& v, const Vec3& rate) {
  const double length = std::sqrt(dot(v, v));
  return (1 / length) * (rate - (dot(v, rate) / (length * length)) * v);
}

// Rate of turning_axes(u, out) * own.
inline Vec3 turning_rate(const Vec3& u, const Vec3& u_rate, const Vec3& out, const Vec3& out_rate,
                         const Vec3& own) {
  if (!(dot(u, u) > 0) || !(dot(out, out) > 0)) return {};
  const Vec3 e = (1 / std::sqrt(dot(u, u))) * u, up = (1 / std::sqrt(dot(out, out))) * out;
  const Vec3 e_rate = direction_rate(u, u_rate), up_rate = direction_rate(out, out_rate);
  return own.x * e_rate + own.y * (cross(up_rate, e) + cross(up, e_rate)) + own.z * up_rate;
}

}  // namespace isochor
