// Sizes of the blocks of a multigrid's matrices, for its files: each has its own kind of dense algebra, which
// costs the compiler dear.
#pragma once

#include <span>
#include <type_traits>

#include "engine/solvers/front/block_matrix.h"

namespace isochor {

inline constexpr Index block_grain = 256;
inline constexpr int modes_per_node = 6;

// Runs body<3>() or body<6>().
template <class Body>
void with_size(int size, const Body& body) {
  if (size == 3)
    body(std::integral_constant<int, 3>());
  else
    body(std::integral_constant<int, 6>());
}

// Inverse diagonal blocks of a matrix, their eigenvalues made positive. Coordinates that do not exist are
// where an eigenvalue is zero; any inverse is right for them.
void invert_diagonal_blocks(const RowLoop& loop, const BlockMatrix& matrix, std::span<double> inverse);

// A symmetric matrix becomes the inverse with its eigenvalues made positive.
void invert_magnitudes(std::span<double> matrix, std::size_t size);

// Calls visit(place, column) for the blocks of a row.
template <class Visit>
void for_row(const BlockMatrix& m, Index row, const Visit& visit) {
  for (auto k = m.start[at(row)]; k < m.start[at(row) + 1]; ++k)
    visit(k, m.column[static_cast<std::size_t>(k)]);
}

}  // namespace isochor
