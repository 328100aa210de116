// Small types shared by the engine's extension headers. Hosts include <isochor/...> instead.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "isochor/types.h"

namespace isochor {

// How much of a function is asked for; each level includes the ones before it.
enum class Want : std::uint8_t { value, gradient, hessian };

// Row-major 3x3 block.
struct Mat3 {
  std::array<double, 9> m{};
  double& operator()(int i, int j) { return m[static_cast<std::size_t>(3 * i + j)]; }
  double operator()(int i, int j) const { return m[static_cast<std::size_t>(3 * i + j)]; }
};

inline Vec3 operator*(const Mat3& a, const Vec3& v) {
  return {a(0, 0) * v.x + a(0, 1) * v.y + a(0, 2) * v.z, a(1, 0) * v.x + a(1, 1) * v.y + a(1, 2) * v.z,
          a(2, 0) * v.x + a(2, 1) * v.y + a(2, 2) * v.z};
}
inline Vec3 transposed_times(const Mat3& a, const Vec3& v) {
  return {a(0, 0) * v.x + a(1, 0) * v.y + a(2, 0) * v.z, a(0, 1) * v.x + a(1, 1) * v.y + a(2, 1) * v.z,
          a(0, 2) * v.x + a(1, 2) * v.y + a(2, 2) * v.z};
}

inline double norm(const Vec3& v) {
  return std::sqrt(dot(v, v));
}
// Its unit vector; zero for zero.
inline Vec3 direction(const Vec3& v) {
  const double length = norm(v);
  return length > 0 ? (1 / length) * v : Vec3{};
}
inline bool finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// m += s a b^T
inline void add_outer(Mat3& m, double s, const Vec3& a, const Vec3& b) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m(i, j) += s * a[i] * b[j];
  }
}
// m += s [w]x, the matrix of the cross product with w.
inline void add_cross(Mat3& m, double s, const Vec3& w) {
  m(0, 1) -= s * w.z;
  m(0, 2) += s * w.y;
  m(1, 0) += s * w.z;
  m(1, 2) -= s * w.x;
  m(2, 0) -= s * w.y;
  m(2, 1) += s * w.x;
}

inline std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

// Lists of lists in two arrays.
struct Lists {
  std::vector<Index> offset{0};
  std::vector<Index> item;

  Index count() const { return static_cast<Index>(offset.size()) - 1; }
  std::span<const Index> operator[](Index i) const {
    return {item.data() + offset[at(i)], at(offset[at(i) + 1] - offset[at(i)])};
  }
  void push(std::span<const Index> list) {
    item.insert(item.end(), list.begin(), list.end());
    offset.push_back(static_cast<Index>(item.size()));
  }
};

// 64-bit FNV-1a over raw bits: two states with the same hash are the same to the last bit.
class Hash {
 public:
  void add(const void* data, std::size_t bytes) {
    const auto* p = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < bytes; ++i) h_ = (h_ ^ p[i]) * 1099511628211ull;
  }
  template <class T>
  void add(std::span<const T> values) {
    add(values.data(), values.size_bytes());
  }
  void add(std::uint64_t v) { add(&v, sizeof v); }
  std::uint64_t value() const { return h_; }

 private:
  std::uint64_t h_ = 1469598103934665603ull;
};

}  // namespace isochor
