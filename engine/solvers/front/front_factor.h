// The numeric part of a multifrontal factorization: A = L D L^T without pivoting, in single or double
// precision.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/solvers/front/block_matrix.h"
#include "engine/solvers/front/front_tree.h"

namespace isochor {

template <class Real>
class FrontFactor {
 public:
  // The tree must outlive the factor. Memory that is there is kept for it.
  void set_tree(const FrontTree& tree);
  // False when a pivot is below `smallest` in magnitude, or not a number; or when `stop`, asked before each
  // front, says so (it may be empty).
  bool factor(const RowLoop& loop, std::span<const double> values, Real smallest,
              const std::function<bool()>& stop = {});
  Index negative_pivots() const;
  // x = A^-1 x, in the sequence of the pattern's unknowns.
  void solve(std::span<Real> x);
  std::size_t bytes() const { return (factor_.size() + work_.size() + pivot_.size()) * sizeof(Real); }

 private:
  void take_memory();
  bool eliminate(Index front, const RowLoop& loop, std::span<const double> values, Real smallest);
  void assemble(Index front, std::span<const double> values);
  bool factor_panel(Index front, const RowLoop& loop, Real smallest);
  void update(Index front, const RowLoop& loop);

  const FrontTree* tree_ = nullptr;
  bool sized_ = false;
  std::vector<Real> factor_, work_, pivot_, permuted_, gathered_;
  std::vector<std::uint8_t> job_ok_;
};

extern template class FrontFactor<float>;
extern template class FrontFactor<double>;

}  // namespace isochor
