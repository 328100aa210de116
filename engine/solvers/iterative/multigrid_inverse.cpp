// Dense inverses of the magnitudes of eigenvalues.
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "engine/solvers/iterative/multigrid_blocks.h"

namespace isochor {

void invert_magnitudes(std::span<double> matrix, std::size_t size) {
  const auto n = static_cast<Eigen::Index>(size);
  Eigen::Map<Eigen::MatrixXd> dense(matrix.data(), n, n);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(dense);
  const auto magnitude = eigen.eigenvalues().cwiseAbs().eval();
  const double least = std::max(1e-10 * magnitude.maxCoeff(), 1e-300);
  dense = eigen.eigenvectors() * magnitude.cwiseMax(least).cwiseInverse().asDiagonal() *
          eigen.eigenvectors().transpose();
}

}  // namespace isochor
