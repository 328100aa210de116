// Symmetric functions of matrices with their derivatives, of small row-major matrices; what the rates of a
// viscoelastic increment are made of (RelaxationPool::rates()).
#pragma once

#include <array>
#include <cmath>

namespace isochor {

using Small = std::array<double, 9>;

inline Small times(const Small& a, const Small& b) {
  Small c{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) c[3 * i + j] += a[3 * i + k] * b[3 * k + j];
    }
  }
  return c;
}

inline Small turned_over(const Small& a) {
  return {a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]};
}

inline Small sum(const Small& a, const Small& b) {
  Small c{};
  for (std::size_t i = 0; i < 9; ++i) c[i] = a[i] + b[i];
  return c;
}

inline Small scaled(double s, Small a) {
  for (double& v : a) v *= s;
  return a;
}

// f of a symmetric matrix V diag(d) V^T: value and derivative along symmetric directions (Daleckii & Krein
// 1965), from divided differences of f.
struct Isotropic {
  Small axes{};
  std::array<double, 3> value{};
  Small divided{};  // f[d_i, d_j]

  Small whole() const {
    Small diagonal{};
    for (std::size_t i = 0; i < 3; ++i) diagonal[4 * i] = value[i];
    return times(times(axes, diagonal), turned_over(axes));
  }
  Small along(const Small& way) const {
    Small inside = times(times(turned_over(axes), way), axes);
    for (std::size_t i = 0; i < 9; ++i) inside[i] *= divided[i];
    return times(times(axes, inside), turned_over(axes));
  }
};

// exp(c A).
inline Isotropic exponential(double c, const Small& axes, const std::array<double, 3>& d) {
  Isotropic out{axes, {}, {}};
  for (std::size_t i = 0; i < 3; ++i) {
    out.value[i] = std::exp(c * d[i]);
    for (std::size_t j = 0; j < 3; ++j) {
      const double x = 0.5 * c * (d[i] - d[j]);
      out.divided[3 * i + j] = c * std::exp(0.5 * c * (d[i] + d[j])) * (x != 0 ? std::sinh(x) / x : 1);
    }
  }
  return out;
}

// log A.
inline Isotropic logarithm(const Small& axes, const std::array<double, 3>& d) {
  Isotropic out{axes, {}, {}};
  for (std::size_t i = 0; i < 3; ++i) {
    out.value[i] = std::log(d[i]);
    for (std::size_t j = 0; j < 3; ++j) {
      const double x = (d[i] - d[j]) / d[j];
      out.divided[3 * i + j] = (x != 0 ? std::log1p(x) / x : 1) / d[j];
    }
  }
  return out;
}

}  // namespace isochor
