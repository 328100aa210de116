// What the backends without pivoting share: the permuted upper triangle, and the cure for pivots that vanish.
#pragma once

#include <vector>

#include "engine/solvers/direct_solver.h"
#include "engine/solvers/ordering.h"

namespace isochor {

// P A P^T = L D L^T with D diagonal exists for quasi-definite matrices in any order, for saddle matrices with
// hard rows in most orders that put a row behind what it constrains, and for other indefinite matrices by
// luck. Where a pivot vanishes, the diagonal is shifted a little, in the direction of the expected sign, and
// refinement against the unshifted matrix takes the error out again. A factor that refinement cannot mend is
// refused.
class LdltSolver : public DirectSolver {
 public:
  explicit LdltSolver(OrderingMethod method) : method_(method) {}

 protected:
  // Upper triangle by columns, rows ascending, every diagonal entry present (the last of its column).
  struct UpperMatrix {
    std::vector<Index> start, row;
    std::vector<double> value;
  };

  // Symbolic factorization of matrix().
  virtual FactorReport analyze_upper() = 0;
  // Numeric factorization of matrix(); false when a pivot is exactly zero. Throws bad_alloc without memory.
  virtual bool factor_upper() = 0;
  virtual double pivot(Index k) const = 0;
  // Solves in the pivot sequence.
  virtual bool solve_permuted(std::span<double> x) = 0;

  UpperMatrix& matrix() { return matrix_; }
  std::int64_t factor_nonzeros = 0;

 private:
  FactorReport analyze_pattern() final;
  FactorReport factor_values() final;
  bool apply_inverse(std::span<double> x) final;

  enum class Shift { none, multipliers, all };
  bool try_factor(Shift shift);
  bool solves_well();

  OrderingMethod method_;
  Ordering ordering_;
  UpperMatrix matrix_;
  std::vector<Index> slot_;                // where a value of the pattern goes in matrix_
  std::vector<std::int64_t> diagonal_of_;  // value index of each unknown's diagonal, -1: not in the pattern
  std::vector<double> permuted_, test_right_, test_solution_;
};

}  // namespace isochor
