// Hyper-dual numbers: a + b e1 + c e2 + d e1 e2 with e1^2 = e2^2 = 0. Evaluating f gives its value, two first
// derivatives and one second derivative, all exact to rounding (Fike & Alonso 2011).
#pragma once

#include <cmath>

namespace test {

struct HyperDual {
  double a = 0, b = 0, c = 0, d = 0;
  HyperDual() = default;
  HyperDual(double value) : a(value) {}
  HyperDual(double value, double e1, double e2, double e12) : a(value), b(e1), c(e2), d(e12) {}

  // f(*this) from f and its derivatives at a.
  HyperDual chain(double f, double first, double second) const {
    return {f, first * b, first * c, first * d + second * b * c};
  }
};

inline HyperDual operator+(const HyperDual& p, const HyperDual& q) {
  return {p.a + q.a, p.b + q.b, p.c + q.c, p.d + q.d};
}
inline HyperDual operator-(const HyperDual& p, const HyperDual& q) {
  return {p.a - q.a, p.b - q.b, p.c - q.c, p.d - q.d};
}
inline HyperDual operator-(const HyperDual& p) {
  return {-p.a, -p.b, -p.c, -p.d};
}
inline HyperDual operator*(const HyperDual& p, const HyperDual& q) {
  return {p.a * q.a, p.a * q.b + p.b * q.a, p.a * q.c + p.c * q.a,
          p.a * q.d + p.b * q.c + p.c * q.b + p.d * q.a};
}
inline HyperDual operator/(const HyperDual& p, const HyperDual& q) {
  return p * q.chain(1 / q.a, -1 / (q.a * q.a), 2 / (q.a * q.a * q.a));
}
inline HyperDual& operator+=(HyperDual& p, const HyperDual& q) {
  return p = p + q;
}
inline HyperDual log(const HyperDual& p) {
  return p.chain(std::log(p.a), 1 / p.a, -1 / (p.a * p.a));
}
inline HyperDual exp(const HyperDual& p) {
  const double e = std::exp(p.a);
  return p.chain(e, e, e);
}
inline HyperDual sqrt(const HyperDual& p) {
  const double s = std::sqrt(p.a);
  return p.chain(s, 0.5 / s, -0.25 / (s * p.a));
}
inline HyperDual atan(const HyperDual& p) {
  const double slope = 1 / (1 + p.a * p.a);
  return p.chain(std::atan(p.a), slope, -2 * p.a * slope * slope);
}
inline HyperDual pow(const HyperDual& p, double n) {
  const double f = std::pow(p.a, n);
  return p.chain(f, n * f / p.a, n * (n - 1) * f / (p.a * p.a));
}

}  // namespace test
