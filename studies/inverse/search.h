// Bounded nonlinear least squares with given Jacobians, by Ceres.
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <string>

namespace isochor::inverse {

// Errors r(x) and, where asked, their Jacobian. False: x has no value (no equilibrium, a mesh that is
// spoiled); the search comes closer to where it was.
using Errors = std::function<bool(const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* jacobian)>;

struct SearchProblem {
  Eigen::VectorXd start, least, most;
  // |prior (x - start)|^2 / 2 is added; 0: nothing.
  Eigen::VectorXd prior;
  Eigen::Index errors = 0;  // how many there are
  Errors evaluate;
};

struct SearchOptions {
  int max_iterations = 100;
  // Steps by conjugate gradients: for thousands of unknowns whose prior is 1, which makes the matrix one and
  // a part of low rank.
  bool many_unknowns = false;
  double function_tolerance = 1e-15, gradient_tolerance = 1e-14, parameter_tolerance = 1e-12;
  std::function<bool()> stop;  // asked once an iteration
  std::function<void(int iteration, double cost, const Eigen::VectorXd& x)> on_iteration;  // of steps taken
};

struct Search {
  bool converged = false, interrupted = false;
  std::string reason;  // where it is not converged
  Eigen::VectorXd x;
  double cost = 0;  // half the sum of squares, prior included
  int iterations = 0;
};

Search search(const SearchProblem& problem, const SearchOptions& options);

}  // namespace isochor::inverse
