#include "engine/math/gmres.h"

#include <algorithm>
#include <cmath>

namespace isochor {

namespace {

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

Gmres::Gmres(std::size_t size, int most) : size_(size), most_(most) {
  const std::size_t m = at(most);
  basis_.resize((m + 1) * size);
  direction_.resize(m * size);
  hessenberg_.resize(m * (m + 1));
  cosine_.resize(m);
  sine_.resize(m);
  right_.resize(m + 1);
}

void Gmres::begin(std::span<const double> b) {
  start_ = left_ = std::sqrt(dot(b, b));
  exhausted_ = false;
  std::fill(right_.begin(), right_.end(), 0.0);
  right_[0] = start_;
  const double inverse = start_ > 0 ? 1 / start_ : 0;
  const auto v = basis(0);
  for (std::size_t i = 0; i < size_; ++i) v[i] = inverse * b[i];
}

// basis(k + 1) holds A z_k: made orthogonal to the basis (modified Gram-Schmidt), its column of the
// Hessenberg matrix rotated into the triangle.
bool Gmres::extend(int k) {
  const auto w = basis(k + 1);
  const double before = std::sqrt(dot(w, w));
  for (int i = 0; i <= k; ++i) {
    const auto v = basis(i);
    const double c = h(i, k) = dot(v, w);
    for (std::size_t j = 0; j < size_; ++j) w[j] -= c * v[j];
  }
  double norm = std::sqrt(dot(w, w));
  if (!std::isfinite(norm) || !(before > 0)) return false;
  if (norm <= 1e-14 * before) {
    norm = 0;
    exhausted_ = true;
  }
  const double inverse = norm > 0 ? 1 / norm : 0;
  for (double& v : w) v *= inverse;
  for (int i = 0; i < k; ++i) {
    const double a = h(i, k), b = h(i + 1, k);
    h(i, k) = cosine_[at(i)] * a + sine_[at(i)] * b;
    h(i + 1, k) = -sine_[at(i)] * a + cosine_[at(i)] * b;
  }
  const double a = h(k, k), length = std::hypot(a, norm);
  if (!(length > 0)) return false;
  cosine_[at(k)] = a / length;
  sine_[at(k)] = norm / length;
  h(k, k) = length;
  right_[at(k) + 1] = -sine_[at(k)] * right_[at(k)];
  right_[at(k)] *= cosine_[at(k)];
  left_ = std::abs(right_[at(k) + 1]);
  return true;
}

void Gmres::combine(int k, std::span<double> x) {
  for (int i = k - 1; i >= 0; --i) {
    double sum = right_[at(i)];
    for (int j = i + 1; j < k; ++j) sum -= h(i, j) * right_[at(j)];
    right_[at(i)] = sum / h(i, i);
  }
  std::fill(x.begin(), x.end(), 0.0);
  for (int i = 0; i < k; ++i) {
    const auto z = direction(i);
    for (std::size_t j = 0; j < size_; ++j) x[j] += right_[at(i)] * z[j];
  }
}

}  // namespace isochor
