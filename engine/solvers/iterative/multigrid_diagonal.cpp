// Diagonal blocks, inverted.
#include <Eigen/Eigenvalues>

#include "engine/solvers/iterative/multigrid_blocks.h"

namespace isochor {

void invert_diagonal_blocks(const RowLoop& loop, const BlockMatrix& matrix, std::span<double> inverse) {
  with_size(matrix.height, [&]<int B>(std::integral_constant<int, B>) {
    using Block = Eigen::Matrix<double, B, B, Eigen::RowMajor>;
    loop(matrix.rows, block_grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        const Eigen::Map<const Block> block(matrix.value.data() + matrix.find(i, i) * (B * B));
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, B, B>> eigen(block);
        auto magnitude = eigen.eigenvalues().cwiseAbs().eval();
        const double largest = magnitude.maxCoeff();
        for (int q = 0; q < B; ++q) {
          if (!(magnitude[q] > 1e-10 * largest)) magnitude[q] = largest > 0 ? largest : 1;
        }
        Eigen::Map<Block> to(inverse.data() + static_cast<std::ptrdiff_t>(i) * (B * B));
        to = eigen.eigenvectors() * magnitude.cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
      }
    });
  });
}

}  // namespace isochor
