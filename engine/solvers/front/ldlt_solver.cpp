#include "engine/solvers/front/ldlt_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/base/base.h"

namespace isochor {
namespace {

// Below this fraction of the largest, a pivot says little about the matrix and much about rounding.
constexpr double doubtful_pivot = 1e-11;
// Fraction of the norm that is added where pivots vanish: its error shrinks by about this factor over the
// smallest eigenvalue with each refinement, and rounding grows by its inverse.
constexpr double shift_fraction = 1e-9;
// Growth of a solution over its right-hand side beyond which the matrix counts as singular.
constexpr double singular_growth = 1e14;

}  // namespace

FactorReport LdltSolver::analyze_pattern() {
  const SymmetricPattern& p = pattern();
  ordering_ = order_unknowns(p, method_);
  const auto n = at(p.size);
  FactorReport report;
  if (p.nonzeros() + p.size > std::numeric_limits<Index>::max()) {
    report.status = FactorStatus::failed;
    report.message = "this backend holds fewer than 2^31 entries";
    return report;
  }

  // Count, then fill by a transposition, which leaves the rows of each column in ascending order.
  diagonal_of_.assign(n, -1);
  std::vector<Index> count(n, 1);  // the diagonal, present in the pattern or not
  const auto each_entry = [&](auto&& visit) {
    for (Index c = 0; c < p.size; ++c) {
      for (auto k = p.column_start[at(c)]; k < p.column_start[at(c) + 1]; ++k) {
        visit(k, ordering_.position[at(p.row[static_cast<std::size_t>(k)])], ordering_.position[at(c)]);
      }
    }
  };
  each_entry([&](std::int64_t k, Index i, Index j) {
    if (i != j) {
      ++count[at(std::max(i, j))];
    } else {
      diagonal_of_[at(ordering_.unknown[at(i)])] = k;
    }
  });
  matrix_.start.assign(n + 1, 0);
  std::partial_sum(count.begin(), count.end(), matrix_.start.begin() + 1);
  const auto entries = at(matrix_.start[n]);
  matrix_.row.resize(entries);
  matrix_.value.assign(entries, 0);
  slot_.resize(p.row.size());

  struct Entry {
    Index row;
    std::int64_t source;  // -1: no value
  };
  std::vector<Entry> entry(entries);
  std::vector<Index> next(matrix_.start.begin(), matrix_.start.end() - 1);
  for (Index j = 0; j < p.size; ++j)
    entry[at(next[at(j)]++)] = {j, diagonal_of_[at(ordering_.unknown[at(j)])]};
  each_entry([&](std::int64_t k, Index i, Index j) {
    if (i != j) entry[at(next[at(std::max(i, j))]++)] = {std::min(i, j), k};
  });
  for (Index j = 0; j < p.size; ++j) {
    const auto begin = entry.begin() + matrix_.start[at(j)], end = entry.begin() + matrix_.start[at(j) + 1];
    std::sort(begin, end, [](const Entry& a, const Entry& b) { return a.row < b.row; });
  }
  for (std::size_t e = 0; e < entries; ++e) {
    matrix_.row[e] = entry[e].row;
    if (entry[e].source >= 0) slot_[static_cast<std::size_t>(entry[e].source)] = static_cast<Index>(e);
  }

  permuted_.assign(n, 0);
  test_solution_.assign(n, 0);
  // A right-hand side without symmetry, so that it has a part along any null vector.
  test_right_.resize(n);
  std::uint32_t state = 12345;
  for (double& b : test_right_) {
    state = state * 1664525u + 1013904223u;
    b = 0.5 + static_cast<double>(state >> 8) / double{1 << 24} * ((state >> 31) != 0u ? 1 : -1);
  }
  report = analyze_upper();
  report.factor_nonzeros = factor_nonzeros;
  return report;
}

bool LdltSolver::try_factor(Shift shift) {
  const std::span<const double> v = values();
  for (std::size_t k = 0; k < v.size(); ++k) matrix_.value[at(slot_[k])] = v[k];
  const SymmetricPattern& p = pattern();
  const double size = shift_fraction * norm();
  for (Index j = 0; j < p.size; ++j) {
    const Index unknown = ordering_.unknown[at(j)];
    const std::int64_t source = diagonal_of_[at(unknown)];
    const double diagonal = source < 0 ? 0 : v[static_cast<std::size_t>(source)];
    const bool multiplier = p.multiplier.empty() ? diagonal <= 0 : p.multiplier[at(unknown)] != 0;
    double added = 0;
    if (shift != Shift::none && multiplier) added = -size;
    if (shift == Shift::all && !multiplier) added = size;
    matrix_.value[at(matrix_.start[at(j) + 1]) - 1] = diagonal + added;
  }
  return factor_upper();
}

// Solves a fixed system: is the factor good enough to solve with, and the matrix far enough from singular?
bool LdltSolver::solves_well() {
  const SolveReport report = refine(test_right_, test_solution_);
  if (!report.ok) return false;
  double largest = 0;
  for (const double x : test_solution_) largest = std::max(largest, std::abs(x));
  // Against the right-hand side, of size 1, alone: a huge solution hides any residual in the relative one.
  return largest * norm() < singular_growth && last_residual_norm() < 1e-3;
}

FactorReport LdltSolver::factor_values() {
  FactorReport report;
  report.factor_nonzeros = factor_nonzeros;
  const auto settle = [&](Shift shift) {
    if (!try_factor(shift)) return false;
    double largest = 0, smallest = std::numeric_limits<double>::infinity(), poison = 0;
    report.negative_pivots = 0;
    for (Index k = 0; k < pattern().size; ++k) {
      const double d = pivot(k);
      largest = std::max(largest, std::abs(d));
      smallest = std::min(smallest, std::abs(d));
      poison += d * 0.0;
      if (d < 0) ++report.negative_pivots;
    }
    if (std::isnan(poison) || smallest == 0) return false;
    const bool doubtful = shift != Shift::none || smallest < doubtful_pivot * largest;
    return !doubtful || solves_well();
  };
  max_refinements = 5;
  if (settle(Shift::none)) return report;
  max_refinements = 10;  // a shifted factor converges more slowly
  if (settle(Shift::multipliers) || settle(Shift::all)) return report;
  report.status = FactorStatus::singular;
  report.negative_pivots = -1;
  report.message = "the matrix is singular, or cannot be factored without pivoting";
  return report;
}

bool LdltSolver::apply_inverse(std::span<double> x) {
  for (std::size_t k = 0; k < permuted_.size(); ++k) permuted_[k] = x[at(ordering_.unknown[k])];
  if (!solve_permuted(permuted_)) return false;
  for (std::size_t k = 0; k < permuted_.size(); ++k) x[at(ordering_.unknown[k])] = permuted_[k];
  return true;
}

}  // namespace isochor
