// Numbers of several points side by side, so that one instruction serves all of them (GCC and Clang vector
// types: AVX-512, AVX2 or SSE2, whichever the build aims at; the answers of a lane do not depend on its
// neighbors).
#pragma once

#include <cmath>
#include <cstring>

#include "engine/base/base.h"

// Where registers are narrower than a batch, the compiler warns that passing one depends on its options. All
// who include this header are compiled with the same ones.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

namespace isochor {

inline constexpr int kLanes = 8;  // deformation gradients per batch

using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));
using LaneMask = long long __attribute__((vector_size(kLanes * sizeof(long long))));  // -1: true, 0: false

inline Lanes load(const double* values) {
  Lanes v;
  std::memcpy(&v, values, sizeof v);
  return v;
}
inline void store(const Lanes& v, double* values) {
  std::memcpy(values, &v, sizeof v);
}
inline Lanes broadcast(double value) {
  return Lanes{} + value;
}
inline Lanes square_root(const Lanes& v) {
  Lanes r;
  for (int l = 0; l < kLanes; ++l) r[l] = std::sqrt(v[l]);
  return r;
}
inline Lanes magnitude(const Lanes& v) {
  return v < 0 ? -v : v;
}
inline Lanes larger(const Lanes& a, const Lanes& b) {
  return a > b ? a : b;
}
inline bool any(const LaneMask& m) {
  long long all = 0;
  for (int l = 0; l < kLanes; ++l) all |= m[l];
  return all != 0;
}

}  // namespace isochor
