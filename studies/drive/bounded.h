// Linear least squares within bounds, exactly.
#pragma once

#include <Eigen/Dense>

namespace isochor::drive {

// The u between `least` and `most` where |A u - b|^2 is smallest; A has full column rank. By an active set
// (Stark & Parker 1995, as Lawson & Hanson's for one bound): it ends at the conditions of an optimum, which
// trust regions that are cut at bounds come to slowly or, in corners, not at all.
struct Bounded {
  bool converged = false;
  Eigen::VectorXd u;
};
Bounded least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, const Eigen::VectorXd& least,
                      const Eigen::VectorXd& most);

}  // namespace isochor::drive
