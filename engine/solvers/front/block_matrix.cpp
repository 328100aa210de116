#include "engine/solvers/front/block_matrix.h"

#include <algorithm>

namespace isochor {
namespace {

constexpr Index grain = 512;

template <int B>
void multiply_blocks(const RowLoop& loop, const BlockMatrix& a, const double* b, const double* x, double* y) {
  loop(a.rows, grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      double sum[B] = {};
      for (auto k = a.start[at(i)]; k < a.start[at(i) + 1]; ++k) {
        const double* const block = a.value.data() + k * (B * B);
        const double* const xk = x + static_cast<std::ptrdiff_t>(a.column[static_cast<std::size_t>(k)]) * B;
        for (int p = 0; p < B; ++p) {
          for (int q = 0; q < B; ++q) sum[p] += block[p * B + q] * xk[q];
        }
      }
      double* const yi = y + static_cast<std::ptrdiff_t>(i) * B;
      const double* const bi = b == nullptr ? nullptr : b + static_cast<std::ptrdiff_t>(i) * B;
      for (int p = 0; p < B; ++p) yi[p] = bi == nullptr ? sum[p] : bi[p] - sum[p];
    }
  });
}

}  // namespace

std::int64_t BlockMatrix::find(Index row, Index col) const {
  const auto begin = column.begin() + start[at(row)], end = column.begin() + start[at(row) + 1];
  return std::lower_bound(begin, end, col) - column.begin();
}

void multiply(const RowLoop& loop, const BlockMatrix& a, std::span<const double> x, std::span<double> y) {
  if (a.height == 3)
    multiply_blocks<3>(loop, a, nullptr, x.data(), y.data());
  else
    multiply_blocks<6>(loop, a, nullptr, x.data(), y.data());
}

void residual(const RowLoop& loop, const BlockMatrix& a, std::span<const double> b, std::span<const double> x,
              std::span<double> r) {
  if (a.height == 3)
    multiply_blocks<3>(loop, a, b.data(), x.data(), r.data());
  else
    multiply_blocks<6>(loop, a, b.data(), x.data(), r.data());
}

}  // namespace isochor
