// With G u + s = g, s >= 0, for the limits that are finite, and z >= 0 their multipliers, an optimum has
//   R^T (R u - c) + G^T z = 0,   G u + s - g = 0,   s z = 0 (each),   A = Q R, c = Q^T b.
// Outline of an iteration:
//   1. R and the square root of z / s times G, below one another, are factored
//   2. Newton's way for s z = 0: how far it goes until a slack or a multiplier is zero tells how much nearer
//      the middle of the path to aim
//   3. the way for that aim, with the second-order part of 2., nearly as far as slacks and multipliers allow
#include "studies/drive/limited.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace isochor::drive {

namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr int kMostIterations = 100;
// Of sizes: where it ends, and what is good enough. Slacks below 1e-10 leave multipliers no digits.
constexpr double kDone = 1e-10, kGood = 1e-8;

class InteriorPoint {
 public:
  InteriorPoint(const Matrix& A, const Vector& b, const Matrix& C, const Vector& lower, const Vector& upper) {
    // What is 1: an objective whose gradient is at most about 1.
    const double size = std::max(A.norm(), 1e-300);
    const Eigen::HouseholderQR<Matrix> qr(A / size);
    R_ = qr.matrixQR().topRows(A.cols()).triangularView<Eigen::Upper>();
    c_ = (qr.householderQ().adjoint() * (b / size)).head(A.cols());
    std::vector<std::pair<Eigen::Index, double>> rows;
    for (Eigen::Index i = 0; i < C.rows(); ++i) {
      if (std::isfinite(upper[i])) rows.emplace_back(i, 1.0);
      if (std::isfinite(lower[i])) rows.emplace_back(i, -1.0);
    }
    G_.resize(static_cast<Eigen::Index>(rows.size()), A.cols());
    g_.resize(G_.rows());
    for (Eigen::Index k = 0; k < G_.rows(); ++k) {
      const auto [row, sign] = rows[static_cast<std::size_t>(k)];
      G_.row(k) = sign * C.row(row);
      g_[k] = sign > 0 ? upper[row] : -lower[row];
    }
  }

  Limited solve() {
    if (G_.rows() == 0) return {true, R_.triangularView<Eigen::Upper>().solve(c_)};
    begin();
    double before = HUGE_VAL;
    Vector best = u_;
    for (int k = 0; k < kMostIterations; ++k) {
      const double now = error();
      if (now < before) best = u_, before = now;
      if (now <= kDone || !(now <= 1e6 * before) || !iterate()) break;
    }
    return {before <= kGood, best};
  }

 private:
  void begin() {
    u_ = Vector::Zero(R_.cols());
    const double slack = std::max(1e-3, (G_ * u_ - g_).maxCoeff());
    s_ = (g_ - G_ * u_).cwiseMax(slack);
    z_ = Vector::Constant(G_.rows(), std::max(1e-6, (R_.transpose() * c_).cwiseAbs().maxCoeff()));
  }

  Vector dual() const { return R_.transpose() * (R_ * u_ - c_) + G_.transpose() * z_; }
  Vector primal() const { return G_ * u_ + s_ - g_; }

  // Of the conditions, over the sizes of what they are made of.
  double error() const {
    const double pull = (R_.transpose() * c_).norm() + (G_.transpose() * z_).norm() + 1e-300;
    const double reach = u_.norm() + g_.cwiseAbs().maxCoeff() + 1e-300;
    return std::max({dual().norm() / pull, primal().norm() / reach, s_.dot(z_) / (pull * reach)});
  }

  struct Way {
    Vector u, s, z;
  };
  // To where the products s z are `wanted`, to first order.
  // As least squares, which keep the digits that squares of weak rows lose.
  Way way(const Eigen::HouseholderQR<Matrix>& factor, const Vector& wanted) const {
    const Vector rp = primal(), rc = s_.cwiseProduct(z_) - wanted;
    Vector right(R_.rows() + s_.size());
    right << c_ - R_ * u_,
        -(z_ + (z_.cwiseProduct(rp) - rc).cwiseQuotient(s_)).cwiseQuotient(z_.cwiseQuotient(s_).cwiseSqrt());
    Way out;
    out.u = factor.solve(right);
    out.s = -rp - G_ * out.u;
    out.z = -(rc + z_.cwiseProduct(out.s)).cwiseQuotient(s_);
    return out;
  }

  // How far until an entry is zero.
  static double until_zero(const Vector& x, const Vector& dx) {
    double part = HUGE_VAL;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      if (dx[i] < 0) part = std::min(part, -x[i] / dx[i]);
    }
    return part;
  }

  bool iterate() {
    Matrix root(R_.rows() + G_.rows(), R_.cols());
    root << R_, z_.cwiseQuotient(s_).cwiseSqrt().asDiagonal() * G_;
    const Eigen::HouseholderQR<Matrix> factor(root);
    const auto rows = static_cast<double>(s_.size());
    const double middle = s_.dot(z_) / rows;
    const Way straight = way(factor, Vector::Zero(s_.size()));
    const double ps = std::min(1.0, until_zero(s_, straight.s)),
                 pz = std::min(1.0, until_zero(z_, straight.z));
    const double ahead = (s_ + ps * straight.s).dot(z_ + pz * straight.z) / rows;
    const double aim = std::max(1e-3, std::pow(ahead / middle, 3)) * middle;
    const Way next = way(factor, Vector::Constant(s_.size(), aim) - straight.s.cwiseProduct(straight.z));
    if (!next.u.allFinite() || !next.z.allFinite()) return false;
    // One length for both: the objective is quadratic.
    constexpr double nearly = 0.995;
    const double part = std::min(1.0, nearly * std::min(until_zero(s_, next.s), until_zero(z_, next.z)));
    u_ += part * next.u;
    s_ = (s_ + part * next.s).cwiseMax(1e-300);
    z_ = (z_ + part * next.z).cwiseMax(1e-300);
    return true;
  }

  Matrix R_, G_;
  Vector c_, g_, u_, s_, z_;
};

}  // namespace

Limited least_squares_within(const Matrix& A, const Vector& b, const Matrix& C, const Vector& lower,
                             const Vector& upper) {
  return InteriorPoint(A, b, C, lower, upper).solve();
}

}  // namespace isochor::drive
