// How a fiber that only pulls answers to E, its squared stretch minus one; for solids and for sheets.
//   exponential: k1/(b k2) (exp(k2 E^b) - 1) (Holzapfel, Gasser & Ogden 2000 with b = 2);
//   toe:         by the stretch s = sqrt(1 + E), see FiberLaw (Weiss, Maker & Govindjee 1996).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "isochor/materials.h"

namespace isochor {

struct FiberResponse {
  double psi, first, second;  // and its derivatives in E
};

inline constexpr FiberResponse kNoFiber{std::numeric_limits<double>::infinity(), 0, 0};

// Ei(x) for x > 0.
inline double exponential_integral(double x) {
#ifdef __cpp_lib_math_special_functions
  return std::expint(x);
#else
  // libc++ has no special functions. All terms are positive: nothing cancels.
  double sum = 0, term = 1;
  for (int n = 1; n < 2000; ++n) {
    term *= x / n;
    sum += term / n;
    if (n > x && term < 1e-17 * sum) break;
  }
  return 0.57721566490153286 + std::log(x) + sum;
#endif
}

// T = s dpsi/ds over the stretch s > 1.
template <class Constants>
FiberResponse toe(const Constants& f, double E) {
  const double s = std::sqrt(1 + E), end = std::min(s, f.straight_stretch);
  // The integral of k1 (exp(k2 (s - 1)) - 1)/s by the exponential integral.
  const double shrink = std::exp(-f.k2);
  double psi =
      f.k1 * (shrink * (exponential_integral(f.k2 * end) - exponential_integral(f.k2)) - std::log(end));
  double T = f.k1 * std::expm1(f.k2 * (end - 1)), slope = f.k1 * f.k2 * std::exp(f.k2 * (end - 1));
  if (s > end) {
    const double offset = T - f.straight_modulus * end;
    psi += f.straight_modulus * (s - end) + offset * std::log(s / end);
    T = f.straight_modulus * s + offset;
    slope = f.straight_modulus;
  }
  if (!std::isfinite(psi)) return kNoFiber;
  const double s2 = s * s;
  return {psi, T / (2 * s2), (slope * s - 2 * T) / (4 * s2 * s2)};
}

// Of k1, k2, law, exponent, straight_modulus and straight_stretch as FiberFamily has them.
template <class Constants>
FiberResponse respond(const Constants& f, double E) {
  if (!(E > 0)) return {0, 0, 0};
  if (f.law == FiberLaw::toe) return toe(f, E);
  const double b = f.exponent, power = b == 2 ? E : std::pow(E, b - 1);  // E^(b - 1)
  const double x = f.k2 * power * E;
  if (x > 690) return kNoFiber;  // beyond the range of numbers
  const double growth = std::exp(x);
  const double psi = f.k2 > 0 ? f.k1 / (b * f.k2) * std::expm1(x) : f.k1 / b * power * E;
  if (b == 2) return {psi, f.k1 * E * growth, f.k1 * (1 + 2 * x) * growth};
  return {psi, f.k1 * power * growth, f.k1 * (b - 1 + b * x) * power / E * growth};
}

// Constants and directions of a family; `who` begins the sentence.
Result<void> check_fibers(const std::string& who, const FiberFamily& family);

}  // namespace isochor
