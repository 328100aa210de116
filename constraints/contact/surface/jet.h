// Numbers that carry their derivatives in N variables along: forward differentiation, to the second order
// where `kCurved`.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace isochor {

template <std::size_t N, bool kCurved>
struct Jet {
  double value = 0;
  std::array<double, N> slope{};
  std::array<double, kCurved ? N*(N + 1) / 2 : 0> bend{};  // row i, column j <= i at i (i + 1) / 2 + j

  // f of a jet, from the value and derivatives of f there.
  Jet through(double f, double first, double second) const {
    Jet out;
    out.value = f;
    for (std::size_t i = 0; i < N; ++i) out.slope[i] = first * slope[i];
    if constexpr (kCurved) {
      std::size_t e = 0;
      for (std::size_t i = 0; i < N; ++i) {
        for (std::size_t j = 0; j <= i; ++j, ++e)
          out.bend[e] = first * bend[e] + second * slope[i] * slope[j];
      }
    }
    return out;
  }
  Jet& add(double factor, const Jet& o) {
    value += factor * o.value;
    for (std::size_t i = 0; i < N; ++i) slope[i] += factor * o.slope[i];
    for (std::size_t e = 0; e < bend.size(); ++e) bend[e] += factor * o.bend[e];
    return *this;
  }
  friend Jet operator+(Jet a, const Jet& b) { return a.add(1, b); }
  friend Jet operator-(Jet a, const Jet& b) { return a.add(-1, b); }
  friend Jet operator*(double s, const Jet& a) { return a.through(s * a.value, s, 0); }
  friend Jet operator*(const Jet& a, const Jet& b) {
    Jet out;
    out.value = a.value * b.value;
    for (std::size_t i = 0; i < N; ++i) out.slope[i] = a.value * b.slope[i] + b.value * a.slope[i];
    if constexpr (kCurved) {
      std::size_t e = 0;
      for (std::size_t i = 0; i < N; ++i) {
        for (std::size_t j = 0; j <= i; ++j, ++e) {
          out.bend[e] =
              a.value * b.bend[e] + b.value * a.bend[e] + a.slope[i] * b.slope[j] + b.slope[i] * a.slope[j];
        }
      }
    }
    return out;
  }
};

template <std::size_t N, bool kCurved>
Jet<N, kCurved> inverse(const Jet<N, kCurved>& a) {
  const double f = 1 / a.value;
  return a.through(f, -f * f, 2 * f * f * f);
}
template <std::size_t N, bool kCurved>
Jet<N, kCurved> root(const Jet<N, kCurved>& a) {
  const double f = std::sqrt(a.value);
  return a.through(f, 0.5 / f, -0.25 / (f * a.value));
}

// Vectors of them.
template <class J>
using JetVec = std::array<J, 3>;

template <class J>
J dot(const JetVec<J>& a, const JetVec<J>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class J>
JetVec<J> cross(const JetVec<J>& a, const JetVec<J>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace isochor
