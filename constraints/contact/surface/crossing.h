// When four points that move straight ahead come to lie in one plane.
#pragma once

#include <algorithm>
#include <cmath>

#include "engine/base/base.h"

namespace isochor {

inline constexpr double kNever = 2;  // a time beyond the way

// The first of the fractions (0, 1] of straight ways at which the volume (p0 - p1) . ((p2 - p1) x (p3 - p1))
// goes from positive to zero while hits(time) is true; kNever where it never does.
template <class Hits>
double first_crossing(const std::array<Vec3, 4>& start, const std::array<Vec3, 4>& end, Hits hits) {
  const auto corner = [&](std::size_t k, double t) { return start[k] + t * (end[k] - start[k]); };
  const auto height = [&](double t) {
    const Vec3 a = corner(1, t);
    return dot(corner(0, t) - a, cross(corner(2, t) - a, corner(3, t) - a));
  };
  // A cubic in time.
  const Vec3 p = start[0] - start[1], u = start[2] - start[1], v = start[3] - start[1];
  const Vec3 dp = end[0] - end[1] - p, du = end[2] - end[1] - u, dv = end[3] - end[1] - v;
  const double c1 = dot(dp, cross(u, v)) + dot(p, cross(du, v)) + dot(p, cross(u, dv));
  const double c2 = dot(dp, cross(du, v)) + dot(dp, cross(u, dv)) + dot(p, cross(du, dv));
  const double c3 = dot(dp, cross(du, dv));
  // Between its turning points it is monotonic.
  std::array<double, 4> knot{0, 1, 1, 1};
  std::size_t knots = 1;
  const double discriminant = c2 * c2 - 3 * c1 * c3;
  if (discriminant > 0) {
    const double q = -(c2 + std::copysign(std::sqrt(discriminant), c2));
    std::array<double, 2> turn{c3 != 0 ? q / (3 * c3) : kNever, q != 0 ? c1 / q : kNever};
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
    if (hits(high)) return high;
  }
  return kNever;
}

}  // namespace isochor
