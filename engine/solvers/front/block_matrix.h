// Sparse matrices of small dense blocks, stored by rows, and the few operations that multigrid needs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/row_loop.h"

namespace isochor {

// Block (row, column[k]) of size height x width is stored row-major at value[k * height * width]. Columns
// ascend in each row.
struct BlockMatrix {
  Index rows = 0, columns = 0;  // in blocks
  int height = 3, width = 3;
  std::vector<std::int64_t> start{0};
  std::vector<Index> column;
  std::vector<double> value;

  std::int64_t blocks() const { return static_cast<std::int64_t>(column.size()); }
  std::size_t block_size() const { return static_cast<std::size_t>(height * width); }
  // Index of a block that is there.
  std::int64_t find(Index row, Index col) const;
  void allocate() { value.assign(column.size() * block_size(), 0.0); }
  std::size_t bytes() const {
    return start.size() * sizeof(std::int64_t) + column.size() * sizeof(Index) +
           value.size() * sizeof(double);
  }
};

// y = A x, and r = b - A x. Blocks are 3 x 3 or 6 x 6.
void multiply(const RowLoop& loop, const BlockMatrix& a, std::span<const double> x, std::span<double> y);
void residual(const RowLoop& loop, const BlockMatrix& a, std::span<const double> b, std::span<const double> x,
              std::span<double> r);

}  // namespace isochor
