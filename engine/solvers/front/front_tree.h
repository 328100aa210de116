// The symbolic part of a multifrontal factorization: which unknowns are eliminated together, in which dense
// front, and which front waits for which.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "engine/base/base.h"
#include "engine/solvers/ordering.h"

namespace isochor {

// Fronts are numbered in the sequence of elimination, children before their parents. A front eliminates the
// pivots [first_pivot[f], first_pivot[f + 1]) and reaches down to the rows that they touch: its own pivots,
// then the update rows, ascending.
struct FrontTree {
  Index size = 0;
  std::vector<Index> unknown, position;  // pivot -> unknown and back
  std::vector<Index> first_pivot;        // fronts + 1
  std::vector<Index> parent;             // -1: a root
  std::vector<std::int64_t> row_start;   // fronts + 1, into row and place_in_parent
  std::vector<Index> row;                // update rows
  std::vector<Index> place_in_parent;    // of each update row, counted in the rows of the parent's front
  std::vector<Index> child_start, child;

  // The values of the pattern that belong to the columns of a front, and their places in its panel.
  std::vector<std::int64_t> entry_start, entry;
  std::vector<std::uint32_t> entry_place;

  std::vector<std::int64_t> panel_start;   // fronts + 1, into the factor
  std::vector<std::int64_t> update_start;  // of the square of update rows, in the workspace
  std::int64_t workspace = 0;              // numbers
  Index largest_panel = 0;                 // largest front, rows

  // Jobs: subtrees that do not touch each other, [job_start[j], job_end[j]), then the fronts above them.
  std::vector<Index> job_start, job_end, above;

  double operations = 0;             // of the factorization, multiplications
  std::int64_t factor_nonzeros = 0;  // without the zeros that amalgamation adds

  Index fronts() const { return static_cast<Index>(parent.size()); }
  Index pivots(Index f) const { return first_pivot[at(f) + 1] - first_pivot[at(f)]; }
  Index updates(Index f) const { return static_cast<Index>(row_start[at(f) + 1] - row_start[at(f)]); }
  Index height(Index f) const { return pivots(f) + updates(f); }
};

// What an ordering would cost: multiplications of the factorization. A small part of the work of the tree.
double operations_of(const SymmetricPattern& pattern, const Ordering& ordering);
// With `best`: of nested dissection, minimum fill and minimum degree the one that costs least. Minimum fill
// wins on sparse meshes, minimum degree on the denser patterns of slender bodies, nested dissection on
// compact ones. The base of the pattern is asked first: where its sequence has up to 15 % more operations
// than there, no other is looked for.
Ordering best_ordering(const SymmetricPattern& pattern, OrderingMethod method = OrderingMethod::best);
FrontTree front_tree(const SymmetricPattern& pattern, const Ordering& ordering);

// The tree of a pattern that several solvers work with, maybe at once: made by the first that asks.
struct SharedAnalysis {
  std::mutex mutex;
  OrderingMethod method = OrderingMethod::best;
  std::shared_ptr<const FrontTree> tree;
};
std::shared_ptr<const FrontTree> shared_front_tree(const SymmetricPattern& pattern, OrderingMethod method);

}  // namespace isochor
