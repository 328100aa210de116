#include "engine/solve/kkt/row_jacobian.h"

#include <algorithm>

namespace isochor {

RowJacobian::RowJacobian(const System& system, std::span<const double> scale)
    : system_(system), scale_(scale) {}

void RowJacobian::column(Index row, std::span<double> column) const {
  std::fill(column.begin(), column.end(), 0.0);
  for_entries(row, [&](std::size_t c, double g) { column[c] = scale_[c] * g; });
}

std::size_t RowJacobian::add_square(Index row, double weight, std::span<const std::int64_t> places,
                                    std::size_t place, std::span<double> matrix) const {
  const NodeUnknowns& nodes = system_.unknowns();
  const Gathers& gathers = system_.gathers();
  const auto begin = gathers.row_begin[at(row)], end = gathers.row_begin[at(row) + 1];
  for (std::size_t a = begin; a < end; ++a) {
    const Index i = gathers.jacobian_ends[a][1], ki = nodes.of(i);
    for (std::size_t b = begin; b <= a; ++b) {
      const Index j = gathers.jacobian_ends[b][1], kj = nodes.of(j);
      for (Index q = 0; q < kj; ++q, ++place) {
        if (places[place] < 0) continue;
        auto to = static_cast<std::size_t>(places[place]);
        const double factor = vector_[b][q] * weight;
        for (Index p = i == j ? q : 0; p < ki; ++p) matrix[to++] += vector_[a][p] * factor;
      }
    }
  }
  return place;
}

}  // namespace isochor
