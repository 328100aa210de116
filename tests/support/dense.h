// Decompositions of small dense matrices, compiled once: each costs seconds in every file that has its own.
#pragma once

#include <Eigen/Core>

#include "isochor/types.h"

namespace test {

// Of a symmetric matrix, ascending; `vectors` in the order of `values`.
struct Spectrum {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
Spectrum spectrum(const Eigen::MatrixXd& symmetric);
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric);
isochor::Index negative_eigenvalues(const Eigen::MatrixXd& symmetric);

// By LU with partial pivots.
Eigen::MatrixXd solve(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
Eigen::MatrixXd inverse(const Eigen::MatrixXd& a);

Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

}  // namespace test
