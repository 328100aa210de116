// Diagonal blocks of a multigrid level, inverted.
#include <Eigen/Eigenvalues>

#include "engine/solvers/iterative/multigrid.h"
#include "engine/solvers/iterative/multigrid_blocks.h"

namespace isochor {

// Inverts the diagonal blocks with their eigenvalues made positive. Coordinates that do not exist are where
// an eigenvalue is zero; any inverse is right for them.
void Multigrid::invert_diagonal(const RowLoop& loop, Level& level) {
  with_size(level.a.height, [&]<int B>(std::integral_constant<int, B>) {
    using Block = Eigen::Matrix<double, B, B, Eigen::RowMajor>;
    loop(level.a.rows, block_grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        const Eigen::Map<const Block> block(level.a.value.data() + level.a.find(i, i) * (B * B));
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, B, B>> eigen(block);
        auto magnitude = eigen.eigenvalues().cwiseAbs().eval();
        const double largest = magnitude.maxCoeff();
        for (int q = 0; q < B; ++q) {
          if (!(magnitude[q] > 1e-10 * largest)) magnitude[q] = largest > 0 ? largest : 1;
        }
        Eigen::Map<Block> inverse(level.diagonal_inverse.data() + static_cast<std::ptrdiff_t>(i) * (B * B));
        inverse =
            eigen.eigenvectors() * magnitude.cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
      }
    });
  });
}

}  // namespace isochor
