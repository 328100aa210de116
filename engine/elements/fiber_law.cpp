#include "engine/elements/fiber_law.h"

#include <cstdio>

#include "engine/base/text.h"

namespace isochor {

namespace {

std::string text(const Vec3& v) {
  char buffer[100];
  std::snprintf(buffer, sizeof buffer, "(%g, %g, %g)", v.x, v.y, v.z);
  return buffer;
}

Result<void> check_direction(const std::string& who, const Vec3& a) {
  const double n = dot(a, a);
  if (n > 0 && std::isfinite(n)) return {};
  return Error{who + " = " + text(a) + " has no direction; give three numbers that are not all zero"};
}

Result<void> check_law(const std::string& who, const FiberFamily& f) {
  if (f.law == FiberLaw::exponential) {
    if (!(f.exponent > 1) || !std::isfinite(f.exponent)) {
      return Error{who + "exponent = " + number(f.exponent) +
                   "; it must be above 1, or fibers would pull with a jump (2 is usual)"};
    }
    if (f.straight_modulus != 0 || f.straight_stretch != 0) {
      return Error{who + "straight_modulus = " + number(f.straight_modulus) + " Pa, straight_stretch = " +
                   number(f.straight_stretch) + ": these are of the toe law; drop them or take that law"};
    }
    return {};
  }
  if (f.exponent != 2 || f.dispersion != 0) {
    return Error{who + "exponent = " + number(f.exponent) + ", dispersion = " + number(f.dispersion) +
                 ": these are of the exponential law; drop them or take that law"};
  }
  if (!(f.k2 > 0)) return Error{who + "k2 = " + number(f.k2) + "; it must be positive for the toe law"};
  if (!(f.straight_modulus >= 0) || !std::isfinite(f.straight_modulus)) {
    return Error{who + "straight_modulus = " + number(f.straight_modulus) + " Pa; it must not be negative"};
  }
  if (!(f.straight_stretch > 1) || !std::isfinite(f.straight_stretch)) {
    return Error{who + "straight_stretch = " + number(f.straight_stretch) +
                 "; the stretch at which fibers are straight must be above 1"};
  }
  return {};
}

}  // namespace

Result<void> check_fibers(const std::string& who, const FiberFamily& f) {
  if (!(f.k1 > 0) || !std::isfinite(f.k1)) {
    return Error{who + "k1 = " + number(f.k1) + " Pa; the stiffness of fibers must be positive"};
  }
  if (!(f.k2 >= 0) || !std::isfinite(f.k2)) {
    return Error{who + "k2 = " + number(f.k2) + "; it must be zero (no stiffening) or positive"};
  }
  if (!(f.dispersion >= 0) || !(f.dispersion <= 1.0 / 3)) {
    return Error{who + "dispersion = " + number(f.dispersion) +
                 "; it must lie between 0 (all fibers parallel) and 1/3 (no direction at all)"};
  }
  if (auto r = check_law(who, f); !r) return r;
  if (f.directions.empty()) return check_direction(who + "direction", f.direction);
  for (std::size_t c = 0; c < f.directions.size(); ++c) {
    if (auto r = check_direction(who + "directions[" + std::to_string(c) + "]", f.directions[c]); !r)
      return r;
  }
  return {};
}

}  // namespace isochor
