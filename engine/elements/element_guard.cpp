#include "engine/elements/element_guard.h"

#include <algorithm>

namespace isochor {

namespace {

// J of a tet that is flat but for rounding.
constexpr double flat = 1e-9;

// The energy and its derivatives with respect to J.
struct Response {
  double value, first, second;
};

// For J below the threshold; a value that is not finite where there is none.
Response guard(const ElementGuard::Barrier& barrier, double J, double J_before) {
  if (!(J_before > flat)) return {0, 0, 0};
  if (!(J > 0)) return {std::numeric_limits<double>::infinity(), 0, 0};
  const double b = barrier.stiffness, q = std::log(J / barrier.threshold);
  return {-b * q * q * q, -3 * b * q * q / J, -3 * b * (2 * q - q * q) / (J * J)};
}

// One lane that is below the threshold.
void evaluate_lane(Want want, const PointBatch& points, ResponseBatch& r, int l, const Response& energy,
                   const double g[9]) {
  r.psi[l] = energy.value;
  if (want == Want::value) return;
  const double first = energy.first, second = energy.second;
  for (int i = 0; i < 9; ++i) r.P[i][l] = first * g[i];
  if (want != Want::hessian) return;
  int k = 0;
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j <= i; ++j, ++k) r.A[k][l] = second * g[i] * g[j];
  }
  for (int i = 1; i < 3; ++i) {
    for (int j = 0; j < i; ++j) {
      const int m = 3 - i - j;
      const double eps = (j + 1) % 3 == i ? -1.0 : 1.0;
      for (int c = 0; c < 3; ++c) {
        for (int d = 0; d < 3; ++d) {
          if (c == d) continue;
          const double sign = (c + 1) % 3 == d ? eps : -eps;
          const int row = 3 * i + c, col = 3 * j + d;
          r.A[row * (row + 1) / 2 + col][l] += sign * first * points.F[3 * m + (3 - c - d)][l];
        }
      }
    }
  }
}

}  // namespace

ElementGuard::ElementGuard(std::vector<Barrier> barriers) : barriers_(std::move(barriers)) {
  for (const Barrier& b : barriers_)
    if (b.stiffness > 0) largest_threshold_ = std::max(largest_threshold_, b.threshold);
}

void ElementGuard::evaluate(Want want, const PointBatch& points, ResponseBatch& r) const {
  const auto& F = points.F;
  for (int l = 0; l < kLanes; ++l) {
    double g[9];
    for (int i = 0; i < 3; ++i) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
      for (int j = 0; j < 3; ++j) {
        const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
        g[3 * i + j] = F[3 * i1 + j1][l] * F[3 * i2 + j2][l] - F[3 * i1 + j2][l] * F[3 * i2 + j1][l];
      }
    }
    const double J = F[0][l] * g[0] + F[1][l] * g[1] + F[2][l] * g[2];
    r.psi[l] = 0;
    if (want != Want::value) {
      for (int i = 0; i < 9; ++i) r.P[i][l] = 0;
    }
    if (want == Want::hessian) {
      for (int i = 0; i < 45; ++i) r.A[i][l] = 0;
    }
    const Barrier& barrier = barriers_[at(points.element[l])];
    if (barrier.stiffness > 0 && !(J >= barrier.threshold)) {
      evaluate_lane(want, points, r, l, guard(barrier, J, points.J_before[l]), g);
    }
  }
}

void ElementGuard::spectrum(const PointBatch& points, const Svd3& svd, Spectrum& out) const {
  Lanes first = {}, second = {};
  for (int l = 0; l < kLanes; ++l) {
    const double J = svd.sigma[0][l] * svd.sigma[1][l] * svd.sigma[2][l];
    const Barrier& barrier = barriers_[at(points.element[l])];
    if (!(barrier.stiffness > 0) || !(J < barrier.threshold)) continue;
    const Response energy = guard(barrier, J, points.J_before[l]);
    first[l] = energy.first;
    second[l] = energy.second;
  }
  out = {};
  add_volume(svd, second, first, out);
}

}  // namespace isochor
