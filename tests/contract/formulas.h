// Invariants of a deformation gradient in hyper-dual numbers, for formulas of energies.
#pragma once

#include <algorithm>
#include <array>

#include "support/hyper_dual.h"

namespace test {

using Gradient9 = std::array<HyperDual, 9>;

inline HyperDual determinant(const Gradient9& F) {
  return F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) +
         F[2] * (F[3] * F[7] - F[4] * F[6]);
}

inline HyperDual trace_C(const Gradient9& F) {
  HyperDual sum;
  for (const HyperDual& f : F) sum += f * f;
  return sum;
}

// tr C^2.
inline HyperDual trace_C2(const Gradient9& F) {
  HyperDual sum;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      HyperDual c;
      for (std::size_t k = 0; k < 3; ++k) c += F[3 * k + i] * F[3 * k + j];
      sum += c * c;
    }
  }
  return sum;
}

// s = sigma_0 + sigma_1 + sigma_2 of the rotation-variant form, without singular values: it is the largest
// root of s^4 - 2 I s^2 - 8 J s + I^2 - 4 II, which Newton's method reaches from above. Each step in
// hyper-dual numbers then makes one more order of the derivatives exact.
inline HyperDual trace_S(const Gradient9& F) {
  const HyperDual I = trace_C(F), J = determinant(F), II = 0.5 * (I * I - trace_C2(F));
  HyperDual s = std::sqrt(3 * std::max(I.a, 1e-300));
  for (int k = 0; k < 60; ++k) {
    const HyperDual f = ((s * s - 2.0 * I) * s - 8.0 * J) * s + I * I - 4.0 * II;
    s = s - f / ((4.0 * s * s - 4.0 * I) * s - 8.0 * J);
  }
  return s;
}

}  // namespace test
