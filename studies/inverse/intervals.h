// How well numbers are known that were found by least squares.
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace isochor::inverse {

// The 0.975 quantile of Student's t with n degrees of freedom.
double student(double n);

struct Known {
  Eigen::MatrixXd covariance;  // s^2 (J^T J)^-1
  // Directions that the errors do not see, below 1e-6 of the one they see most, of unknowns each scaled to do
  // as much as another: the unknowns that they move most.
  std::vector<std::vector<std::size_t>> not_apart;
};

// From the Jacobian of errors of variance s^2; unknowns that are `held`, at a bound, are known to be there.
Known known_from(const Eigen::MatrixXd& jacobian, double variance, const std::vector<char>& held);

}  // namespace isochor::inverse
