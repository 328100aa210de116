// The coarsest level of a multigrid, solved by dense factors.
#include <Eigen/Cholesky>
#include <algorithm>

#include "engine/solvers/iterative/multigrid.h"
#include "engine/solvers/iterative/multigrid_blocks.h"

namespace isochor {

void Multigrid::factor_coarsest() {
  const Level& level = levels_.back();
  const int b = level.a.height;
  const auto n = static_cast<Eigen::Index>(level.x.size());
  Eigen::Map<Eigen::MatrixXd> dense(coarse_.data(), n, n);
  const auto fill = [&] {
    dense.setZero();
    for (Index i = 0; i < level.a.rows; ++i) {
      for_row(level.a, i, [&](std::int64_t k, Index j) {
        for (int p = 0; p < b; ++p) {
          for (int q = 0; q < b; ++q) {
            // Rounding in the projection is taken out, as it would take the symmetry.
            const double half = 0.5 * level.a.value[static_cast<std::size_t>(k * b * b + p * b + q)];
            dense(i * b + p, j * b + q) += half;
            dense(j * b + q, i * b + p) += half;
          }
        }
      });
    }
    for (Eigen::Index q = 0; q < n; ++q) {
      if (dense(q, q) == 0 && dense.col(q).isZero(0)) dense(q, q) = 1;
    }
  };
  fill();
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> cholesky(dense);
  // A pivot that only rounding kept above zero is no better than a negative one.
  const auto pivots = dense.diagonal().array().square();
  coarse_definite_ = cholesky.info() == Eigen::Success && pivots.minCoeff() > 1e-12 * pivots.maxCoeff();
  if (coarse_definite_) return;
  fill();
  invert_magnitudes(coarse_, level.x.size());
}

void Multigrid::solve_coarsest(std::span<const double> b, std::span<double> x) {
  const auto n = static_cast<Eigen::Index>(b.size());
  const Eigen::Map<const Eigen::MatrixXd> dense(coarse_.data(), n, n);
  const Eigen::Map<const Eigen::VectorXd> right(b.data(), n);
  Eigen::Map<Eigen::VectorXd> solution(x.data(), n);
  if (coarse_definite_) {
    solution = right;
    dense.triangularView<Eigen::Lower>().solveInPlace(solution);
    dense.transpose().triangularView<Eigen::Upper>().solveInPlace(solution);
  } else {
    solution.noalias() = dense * right;
  }
}

}  // namespace isochor
