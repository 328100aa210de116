// Processes that work on one scene together, each with its share of the stencils and of the matrix.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "isochor/choices.h"
#include "isochor/export.h"

namespace isochor {

class LinearSolver;  // engine-side

// What a host lends to a world whose matrix is shared out (Host::ranks). Every rank makes the same calls on
// worlds in the same order, so that what one waits for comes from all others.
class ISOCHOR_API Ranks {
 public:
  virtual ~Ranks() = default;
  virtual int rank() const = 0;  // 0 .. size() - 1
  virtual int size() const = 0;
  // values := sum over all ranks, entry by entry, with the same bits on every rank.
  virtual void sum(std::span<double> values) const = 0;
  // `values` has a part of every rank: that of rank r lies in [begin[r], begin[r + 1]). Hands the own part to
  // all others.
  virtual void gather(std::span<double> values, std::span<const std::int64_t> begin) const = 0;
  // Who solves the linear systems; null where there is no such solver across ranks. `prefer_iterative`: of
  // the automatic one.
  virtual std::unique_ptr<LinearSolver> linear_solver(Solver kind, bool prefer_iterative) const = 0;
};

}  // namespace isochor
