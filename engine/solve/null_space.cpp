// Who is to blame for a matrix that no shift mends: nodes that may move without a force, or effects whose
// rows depend on each other.
#include <algorithm>
#include <cmath>

#include "engine/solve/inertia_correction.h"

namespace isochor {

// Inverse iteration on the matrix with a little of everything on its diagonal: the vector that it maps to
// next to nothing tells what is wrong with a matrix that no shift mends.
void InertiaCorrection::explain_singular(SaddleReport& report) {
  constexpr double regularization = 1e-4;
  constexpr int iterations = 4;
  if (evaluator_.system().kkt().size == 0) return;
  const double trace = trace_;
  trace_ = regularization;
  SaddleReport unused;
  factor_shifted(regularization, unused);
  trace_ = trace;
  const auto size = at(evaluator_.system().kkt().size);
  std::vector<double> right(size), null(size);
  for (std::size_t i = 0; i < size; ++i) right[i] = 1 + 0.3 * std::sin(static_cast<double>(i));
  for (int k = 0; k < iterations; ++k) {
    if ((interrupt_ && interrupt_()) || !kkt_.linear_solver().solve(right, null).ok) return;
    double square = 0;
    for (const double v : null) square += v * v;
    if (!(square > 0) || !std::isfinite(square)) return;
    for (std::size_t i = 0; i < size; ++i) right[i] = null[i] / std::sqrt(square);
  }
  double rows = 0;
  for (std::size_t i = at(evaluator_.system().free_unknowns()); i < size; ++i) rows += right[i] * right[i];
  if (rows > 0.5) name_rows(right, report);
  if (rows <= 0.5) name_nodes(right, report);
}

// The effects whose rows have a share in a null vector, and the nodes of the row that has most.
void InertiaCorrection::name_rows(std::span<const double> null, SaddleReport& report) const {
  const System& s = evaluator_.system();
  const auto first_row = at(s.free_unknowns());
  double largest = 0;
  Index worst = -1;
  for (std::size_t k = 0; k < s.kept_rows().size(); ++k) {
    if (std::abs(null[first_row + k]) <= largest) continue;
    largest = std::abs(null[first_row + k]);
    worst = s.kept_rows()[k];
  }
  for (std::size_t p = 0; p < s.parts().row_pools.size(); ++p) {
    const RowPool& pool = *s.parts().row_pools[p];
    if (pool.law != RowLaw::compliant) continue;
    const Index first = s.first_row(static_cast<Index>(p));
    for (std::size_t k = 0; k < s.kept_rows().size(); ++k) {
      const Index r = s.kept_rows()[k] - first;
      if (r < 0 || r >= pool.rows() || std::abs(null[first_row + k]) < 0.1 * largest) continue;
      report.null_rows.emplace_back(pool.name());
      break;
    }
  }
  constexpr std::size_t enough = 8;
  for (const auto& [row, node] : s.jacobian_ends()) {
    if (row == worst && report.null_nodes.size() < enough) report.null_nodes.push_back(node);
  }
}

void InertiaCorrection::name_nodes(std::span<const double> null, SaddleReport& report) const {
  const auto first = evaluator_.system().first_unknown();
  std::vector<std::pair<double, Index>> moves;
  for (Index i = 0; i < evaluator_.system().nodes(); ++i) {
    double square = 0;
    for (Index c = first[at(i)]; c < first[at(i) + 1]; ++c) square += null[at(c)] * null[at(c)];
    moves.emplace_back(-square, i);
  }
  constexpr std::size_t enough = 8;
  const auto count = std::min(enough, moves.size());
  std::partial_sort(moves.begin(), moves.begin() + static_cast<std::ptrdiff_t>(count), moves.end());
  for (std::size_t k = 0; k < count && moves[k].first <= 0.1 * moves[0].first && moves[0].first < 0; ++k)
    report.null_nodes.push_back(moves[k].second);
}

}  // namespace isochor
