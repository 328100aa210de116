// Elementary functions of several numbers side by side, so that a law pays for one logarithm what the others
// pay for eight. Relative errors are a few units in the last place; log(1) and exp(0) are exact. Each lane's
// answer is its own.
#pragma once

#include <limits>

#include "engine/math/lanes.h"

namespace isochor {

namespace lane_detail {

// log 2 in two parts; the first has trailing zeros, so that its product with an exponent is exact.
inline constexpr double kLog2High = 0x1.62e42fefa3800p-1, kLog2Low = 0x1.ef35793c76730p-45;

inline LaneMask bits(const Lanes& v) {
  LaneMask m;
  std::memcpy(&m, &v, sizeof m);
  return m;
}
inline Lanes from_bits(const LaneMask& m) {
  Lanes v;
  std::memcpy(&v, &m, sizeof v);
  return v;
}
// Whole numbers of at most 2^51 to and from the bits of a double.
inline constexpr double kShift = 0x1.8p52;
inline Lanes to_double(const LaneMask& whole) {
  return from_bits(whole + bits(broadcast(kShift))) - kShift;
}
inline LaneMask to_whole(const Lanes& v) {
  return bits(v + kShift) - bits(broadcast(kShift));
}
inline Lanes power_of_two(const LaneMask& k) {
  return from_bits((k + 1023) << 52);
}

}  // namespace lane_detail

// Natural logarithm. Lanes that are not positive normal numbers give what is no number.
inline Lanes log(const Lanes& v) {
  using namespace lane_detail;
  // v = 2^k m with m in [1/sqrt 2, sqrt 2), and log m = 2 atanh s with s = (m - 1)/(m + 1).
  constexpr long long root_half = 0x3fe6a09e667f3bcdLL, mantissa = 0xfffffffffffffLL;
  const LaneMask shifted = bits(v) - root_half;
  const LaneMask k = shifted >> 52;
  const Lanes m = from_bits((shifted & mantissa) + root_half), f = m - 1, s = f / (2 + f), z = s * s;
  Lanes series = broadcast(1.0 / 23);
  for (int n = 21; n >= 3; n -= 2) series = series * z + 1.0 / n;
  // f - s (f - 2 z series) is 2 s + 2 s z series with the large part exact.
  const Lanes exponent = to_double(k);
  const Lanes r = exponent * kLog2High + (f - (s * (f - 2 * z * series) - exponent * kLog2Low));
  const LaneMask normal = (v >= 0x1p-1022) & (v <= 0x1.fffffffffffffp1023);
  return normal ? r : broadcast(std::nan(""));
}

namespace lane_detail {

// exp(v) = 2^k (1 + small), the power in two factors since it alone may overflow where the product does not.
struct Exponential {
  Lanes small, scale, rest;
};
inline Exponential exponential(const Lanes& v) {
  const Lanes x = v > 709.7 ? broadcast(709.7) : (v < -709.0 ? broadcast(-709) : v);
  const LaneMask k = to_whole(x * 0x1.71547652b82fep+0);
  const Lanes n = to_double(k), r = (x - n * kLog2High) - n * kLog2Low;
  Lanes series = broadcast(1.0 / 14);  // r (1 + r/2 (1 + r/3 (...)))
  for (int i = 13; i >= 2; --i) series = (series * r + 1) * (1.0 / i);
  return {r + r * r * series, power_of_two(k >> 1), power_of_two(k - (k >> 1))};
}
// Infinity beyond the range of numbers, what is no number as it is.
inline Lanes within_range(const Lanes& v, const Lanes& result) {
  // What is not a number stays so.
  // NOLINTNEXTLINE(misc-redundant-expression)
  return v > 709.7 ? broadcast(std::numeric_limits<double>::infinity()) : (v == v ? result : v);
}

}  // namespace lane_detail

inline Lanes exp(const Lanes& v) {
  const lane_detail::Exponential e = lane_detail::exponential(v);
  return lane_detail::within_range(v, (e.scale + e.scale * e.small) * e.rest);
}
// exp(v) - 1.
inline Lanes expm1(const Lanes& v) {
  const lane_detail::Exponential e = lane_detail::exponential(v);
  return lane_detail::within_range(v, (e.scale * e.small) * e.rest + (e.scale * e.rest - 1));
}

// log(1 + v).
inline Lanes log1p(const Lanes& v) {
  const Lanes u = 1 + v;
  return log(u) + (v - (u - 1)) / u;
}

}  // namespace isochor
