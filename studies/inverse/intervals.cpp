#include "studies/inverse/intervals.h"

#include <algorithm>
#include <cmath>

namespace isochor::inverse {

// By its expansion in 1/n about the quantile of the normal distribution (Abramowitz & Stegun 26.7.5).
double student(double n) {
  constexpr double z = 1.959963984540054;
  const double z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
  return z + (z3 + z) / (4 * n) + (5 * z5 + 16 * z3 + 3 * z) / (96 * n * n) +
         (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * n * n * n);
}

Known known_from(const Eigen::MatrixXd& jacobian, double variance, const std::vector<char>& held) {
  const auto n = jacobian.cols();
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!held[static_cast<std::size_t>(i)]) free.push_back(i);
  }
  Known out;
  out.covariance = Eigen::MatrixXd::Zero(n, n);
  if (free.empty()) return out;
  Eigen::MatrixXd j(jacobian.rows(), static_cast<Eigen::Index>(free.size()));
  Eigen::VectorXd norm(j.cols());
  for (Eigen::Index k = 0; k < j.cols(); ++k) {
    j.col(k) = jacobian.col(free[static_cast<std::size_t>(k)]);
    norm[k] = std::max(j.col(k).norm(), 1e-300);
    j.col(k) /= norm[k];
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(j, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd& s = svd.singularValues();
  for (Eigen::Index k = 0; k < s.size(); ++k) {
    const Eigen::VectorXd direction = svd.matrixV().col(k);
    if (s[k] < 1e-6 * s[0]) {
      std::vector<std::size_t> moved;
      for (Eigen::Index i = 0; i < j.cols(); ++i) {
        if (std::abs(direction[i]) > 0.3 * direction.cwiseAbs().maxCoeff())
          moved.push_back(static_cast<std::size_t>(free[static_cast<std::size_t>(i)]));
      }
      out.not_apart.push_back(std::move(moved));
    }
    const double seen = std::max(s[k], 1e-16 * s[0]);
    for (Eigen::Index a = 0; a < j.cols(); ++a) {
      for (Eigen::Index b = 0; b < j.cols(); ++b) {
        out.covariance(free[static_cast<std::size_t>(a)], free[static_cast<std::size_t>(b)]) +=
            variance / (seen * seen) * direction[a] * direction[b] / (norm[a] * norm[b]);
      }
    }
  }
  return out;
}

}  // namespace isochor::inverse
