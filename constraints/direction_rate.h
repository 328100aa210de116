// How the direction of a vector changes with it.
#pragma once

#include <cmath>

#include "engine/base.h"

namespace isochor {

// Rate of v / |v|.
inline Vec3 direction_rate(const Vec3& v, const Vec3& rate) {
  const double length = std::sqrt(dot(v, v));
  return (1 / length) * (rate - (dot(v, rate) / (length * length)) * v);
}

}  // namespace isochor
