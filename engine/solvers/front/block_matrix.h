// Sparse matrices of small dense blocks, stored by rows, and the few operations that multigrid needs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/base.h"
#include "engine/base/parallel.h"

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

// Loops over block rows; without a parallel loop in the calling thread.
class RowLoop {
 public:
  explicit RowLoop(const Parallel* parallel = nullptr) : parallel_(parallel) {}
  template <class Body>
  void operator()(Index n, Index grain, const Body& body) const {
    if (parallel_ != nullptr) {
      parallel_->run(n, grain, RangeBody(body));
    } else {
      body(Index{0}, n);
    }
  }

 private:
  const Parallel* parallel_;
};

// Sums in blocks of fixed size, so that the bits do not depend on the number of threads.
class BlockedDot {
 public:
  void allocate(std::size_t size) { partial_.resize((size + block - 1) / block); }
  double operator()(const RowLoop& loop, std::span<const double> a, std::span<const double> b);

 private:
  static constexpr std::size_t block = 4096;
  std::vector<double> partial_;
};

// y = A x, and r = b - A x. Blocks are 3 x 3 or 6 x 6.
void multiply(const RowLoop& loop, const BlockMatrix& a, std::span<const double> x, std::span<double> y);
void residual(const RowLoop& loop, const BlockMatrix& a, std::span<const double> b, std::span<const double> x,
              std::span<double> r);

}  // namespace isochor
