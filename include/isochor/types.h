// Plain types that every host-facing header of Isochor uses. No third-party type appears here.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>

namespace isochor {

using Index = std::int32_t;

// A point, displacement [m], velocity [m/s] or force [N], by context.
struct Vec3 {
  double x = 0, y = 0, z = 0;

  double& operator[](int i) { return i == 0 ? x : (i == 1 ? y : z); }
  double operator[](int i) const { return i == 0 ? x : (i == 1 ? y : z); }
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

inline Vec3 operator+(const Vec3& a, const Vec3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3 operator-(const Vec3& a, const Vec3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3 operator-(const Vec3& a) {
  return {-a.x, -a.y, -a.z};
}
inline Vec3 operator*(double s, const Vec3& a) {
  return {s * a.x, s * a.y, s * a.z};
}
inline Vec3 operator*(const Vec3& a, double s) {
  return s * a;
}
inline Vec3& operator+=(Vec3& a, const Vec3& b) {
  return a = a + b;
}
inline Vec3& operator-=(Vec3& a, const Vec3& b) {
  return a = a - b;
}
inline double dot(const Vec3& a, const Vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

enum class ErrorKind : std::uint8_t { refused, no_memory };

// Why a call failed: one sentence that names what, where, the value and the remedy.
struct Error {
  std::string message;
  ErrorKind kind = ErrorKind::refused;
};

// A value or the reason why there is none. Never throws. Test it before value(): a failed result has none.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}
  Result(Error error) : content_(std::move(error)) {}

  explicit operator bool() const { return content_.index() == 0; }
  bool ok() const { return content_.index() == 0; }
  T& value() & { return *std::get_if<0>(&content_); }
  const T& value() const& { return *std::get_if<0>(&content_); }
  T&& value() && { return std::move(*std::get_if<0>(&content_)); }
  const std::string& error() const { return failure().message; }
  const Error& failure() const { return *std::get_if<1>(&content_); }  // to be handed on as it is

 private:
  std::variant<T, Error> content_;
};

template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : failure_(std::move(error)), failed_(true) {}

  explicit operator bool() const { return !failed_; }
  bool ok() const { return !failed_; }
  const std::string& error() const { return failure_.message; }
  const Error& failure() const { return failure_; }

 private:
  Error failure_;
  bool failed_ = false;
};

// How the linear systems take a row. All give the same answer, to solver accuracy.
enum class RowTreatment : std::uint8_t {
  automatic,  // what docs/solver.md says
  saddle,     // an unknown of the matrix, with a negative pivot
  condensed,  // eliminated beforehand, K += G^T G / C: local rows with a positive, diagonal compliance
  bordered,   // eliminated around the factorization: a few rows over many nodes, without fill in the matrix
  dual,       // conjugate gradients on the multipliers around the factors of the stiffness alone
  augmented,  // the same with G^T W G added to the stiffness, which leaves the solution where it is
};

// What a method does with the indefinite Hessian of an element: keeps it, raises its negative eigenvalues to
// zero, or turns them positive.
enum class Definiteness : std::uint8_t { exact, projected, absolute };

}  // namespace isochor
