// From one multigrid level to the next: products of block matrices.
#include <Eigen/Core>
#include <algorithm>

#include "engine/solvers/iterative/multigrid.h"
#include "engine/solvers/iterative/multigrid_blocks.h"

namespace isochor {

// P = (I - omega D^-1 A) P_tentative.
void Multigrid::smooth_prolongation(const RowLoop& loop, Level& level) {
  constexpr int m = modes_per_node;
  const double omega = 4.0 / 3.0 / level.bound;
  with_size(level.a.height, [&]<int B>(std::integral_constant<int, B>) {
    using Square = Eigen::Matrix<double, B, B, Eigen::RowMajor>;
    using Wide = Eigen::Matrix<double, B, m, Eigen::RowMajor>;
    loop(level.a.rows, 64, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        const auto first = level.p.start[at(i)], last = level.p.start[at(i) + 1];
        std::fill(level.p.value.data() + first * (B * m), level.p.value.data() + last * (B * m), 0.0);
        for_row(level.a, i, [&](std::int64_t k, Index j) {
          Eigen::Map<Wide> to(level.p.value.data() + level.p.find(i, level.aggregate[at(j)]) * (B * m));
          to.noalias() +=
              Eigen::Map<const Square>(level.a.value.data() + k * (B * B)) *
              Eigen::Map<const Wide>(level.tentative.data() + static_cast<std::ptrdiff_t>(j) * (B * m));
        });
        const Square weight = -omega * Eigen::Map<const Square>(level.diagonal_inverse.data() +
                                                                static_cast<std::ptrdiff_t>(i) * (B * B));
        for (auto k = first; k < last; ++k) {
          Eigen::Map<Wide> block(level.p.value.data() + k * (B * m));
          block = (weight * block).eval();
        }
        Eigen::Map<Wide> own(level.p.value.data() + level.p.find(i, level.aggregate[at(i)]) * (B * m));
        own += Eigen::Map<const Wide>(level.tentative.data() + static_cast<std::ptrdiff_t>(i) * (B * m));
      }
    });
  });
}

// The coarse matrix P^T (A P), block row by block row.
void Multigrid::project(const RowLoop& loop, Level& level, Level& coarse) {
  constexpr int m = modes_per_node;
  with_size(level.a.height, [&]<int B>(std::integral_constant<int, B>) {
    using Square = Eigen::Matrix<double, B, B, Eigen::RowMajor>;
    using Wide = Eigen::Matrix<double, B, m, Eigen::RowMajor>;
    using Coarse = Eigen::Matrix<double, m, m, Eigen::RowMajor>;
    loop(level.a.rows, 64, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        const auto first = level.ap.start[at(i)], last = level.ap.start[at(i) + 1];
        std::fill(level.ap.value.data() + first * (B * m), level.ap.value.data() + last * (B * m), 0.0);
        for_row(level.a, i, [&](std::int64_t k, Index j) {
          const Square block = Eigen::Map<const Square>(level.a.value.data() + k * (B * B));
          auto to = first;  // both rows ascend
          for_row(level.p, j, [&](std::int64_t q, Index g) {
            while (level.ap.column[static_cast<std::size_t>(to)] != g) ++to;
            Eigen::Map<Wide>(level.ap.value.data() + to * (B * m)).noalias() +=
                block * Eigen::Map<const Wide>(level.p.value.data() + q * (B * m));
          });
        });
      }
    });
    loop(level.aggregates, 16, [&](Index begin, Index end) {
      for (Index g = begin; g < end; ++g) {
        const auto first = coarse.a.start[at(g)], last = coarse.a.start[at(g) + 1];
        std::fill(coarse.a.value.data() + first * (m * m), coarse.a.value.data() + last * (m * m), 0.0);
        for (auto k = level.p_start[at(g)]; k < level.p_start[at(g) + 1]; ++k) {
          const auto place = static_cast<std::size_t>(k);
          const Wide left = Eigen::Map<const Wide>(level.p.value.data() + level.p_by_column[place] * (B * m));
          auto to = first;
          for_row(level.ap, level.p_row[place], [&](std::int64_t q, Index j) {
            while (coarse.a.column[static_cast<std::size_t>(to)] != j) ++to;
            Eigen::Map<Coarse>(coarse.a.value.data() + to * (m * m)).noalias() +=
                left.transpose() * Eigen::Map<const Wide>(level.ap.value.data() + q * (B * m));
          });
        }
      }
    });
  });
}

}  // namespace isochor
