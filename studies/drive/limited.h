// Linear least squares where sums of unknowns have limits as well: what the rates of amounts are.
#pragma once

#include <Eigen/Dense>

namespace isochor::drive {

struct Limited {
  bool converged = false;  // the conditions of an optimum hold to about seven digits
  Eigen::VectorXd u;
};

// The u with lower <= C u <= upper where |A u - b|^2 is smallest; A has full column rank, and there are u
// between all limits, some of which may be infinite. By an interior point (Mehrotra 1992): some twenty
// factorizations, however many limits hold. Ceres, which fits go by, takes bounds of unknowns and none of
// their sums; least squares by Ceres with multipliers for the sums came to eight digits in a thousand steps
// or not at all.
Limited least_squares_within(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, const Eigen::MatrixXd& C,
                             const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

}  // namespace isochor::drive
