#include "engine/solvers/gmres.h"

#include <algorithm>
#include <cmath>

namespace isochor {

namespace {

constexpr Index grain = 8192;

}  // namespace

Gmres::Gmres(std::size_t size, int most, Directions directions)
    : size_(size), most_(most), kept_(directions == Directions::kept) {
  const std::size_t m = at(most);
  dot_.allocate(size);
  basis_.resize((m + 1) * size);
  direction_.resize((kept_ ? m : 1) * size);
  hessenberg_.resize(m * (m + 1));
  cosine_.resize(m);
  sine_.resize(m);
  right_.resize(m + 1);
}

void Gmres::add(double factor, std::span<const double> v, std::span<double> w) const {
  loop_(static_cast<Index>(size_), grain, [&](Index begin, Index end) {
    for (Index j = begin; j < end; ++j) w[at(j)] += factor * v[at(j)];
  });
}

void Gmres::set(double factor, std::span<const double> v, std::span<double> w) const {
  loop_(static_cast<Index>(size_), grain, [&](Index begin, Index end) {
    for (Index j = begin; j < end; ++j) w[at(j)] = factor * v[at(j)];
  });
}

void Gmres::begin(std::span<const double> b) {
  start_ = left_ = std::sqrt(dot(b, b));
  exhausted_ = odd_ = false;
  std::fill(right_.begin(), right_.end(), 0.0);
  right_[0] = start_;
  set(start_ > 0 ? 1 / start_ : 0, b, basis(0));
}

// basis(k + 1) holds A z_k: made orthogonal to the basis (modified Gram-Schmidt), its column of the
// Hessenberg matrix rotated into the triangle.
bool Gmres::extend(int k) {
  const auto w = basis(k + 1);
  const double before = std::sqrt(dot(w, w));
  for (int i = 0; i <= k; ++i) {
    const auto v = basis(i);
    const double c = h(i, k) = dot(v, w);
    add(-c, v, w);
  }
  double norm = std::sqrt(dot(w, w));
  if (!std::isfinite(norm) || !(before > 0)) return false;
  if (norm <= 1e-14 * before) {
    norm = 0;
    exhausted_ = true;
  }
  set(norm > 0 ? 1 / norm : 0, w, w);
  for (int i = 0; i < k; ++i) {
    const double a = h(i, k), b = h(i + 1, k);
    h(i, k) = cosine_[at(i)] * a + sine_[at(i)] * b;
    h(i + 1, k) = -sine_[at(i)] * a + cosine_[at(i)] * b;
  }
  const double a = h(k, k), length = std::hypot(a, norm);
  if (!(length > 0)) return false;
  odd_ = a < 0;  // rotations and the pivots before have a positive determinant
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
  for (int i = 0; i < k; ++i) add(right_[at(i)], kept_ ? direction(i) : basis(i), x);
}

}  // namespace isochor
