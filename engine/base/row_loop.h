// Loops over long vectors and rows of matrices, and sums over them, by however many threads there are.
#pragma once

#include <span>
#include <vector>

#include "engine/base/base.h"
#include "engine/base/parallel.h"

namespace isochor {

// Without a parallel loop in the calling thread.
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

}  // namespace isochor
