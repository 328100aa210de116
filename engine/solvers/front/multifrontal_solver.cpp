#include "engine/solvers/front/multifrontal_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/base.h"

namespace isochor {
namespace {

// A pivot below this fraction of the norm has lost most of its digits.
constexpr double smallest_single = 1e-6, smallest_double = 1e-13;
// Less of a reduction of the residual by a refinement, and an eigenvalue may have changed its sign.
constexpr double largest_ratio = 0.25;
// Where refinement ends. In single precision each costs a solve, and brings three digits.
constexpr double enough_for_single = 1e-14;
constexpr double rounding_level = 2 * std::numeric_limits<double>::epsilon();

}  // namespace

MultifrontalSolver::MultifrontalSolver(std::unique_ptr<LinearSolver> pivoting,
                                       const MultifrontalOptions& options)
    : pivoting_(std::move(pivoting)), options_(options) {
  begin_solve();
}

void MultifrontalSolver::set_parallel(const Parallel& parallel) {
  loop_ = RowLoop(&parallel);
  if (pivoting_) pivoting_->set_parallel(parallel);
}

void MultifrontalSolver::set_interrupt(std::function<bool()> asked) {
  if (pivoting_) pivoting_->set_interrupt(asked);
  LinearSolver::set_interrupt(std::move(asked));
}

void MultifrontalSolver::set_scale(std::span<const double> scale) {
  if (pivoting_) pivoting_->set_scale(scale);
}

void MultifrontalSolver::begin_solve() {
  const bool single = options_.single_precision && tree_->operations >= options_.single_from;
  lowest_ = single ? Rung::single : Rung::full;
}

std::string MultifrontalSolver::reason() const {
  std::string text;
  const auto add = [&](Rung rung, const std::string& what) {
    const std::int64_t count = used_[static_cast<int>(rung)];
    if (count > 0) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + what;
  };
  add(Rung::single, "factorizations in single precision");
  add(Rung::full, "in double precision");
  if (pivoting_) add(Rung::pivoting, "pivoted by " + std::string(pivoting_->name()));
  return text;
}

FactorReport MultifrontalSolver::analyze_pattern() {
  const SymmetricPattern& p = pattern();
  const auto n = at(p.size);
  FactorReport report;
  if (p.nonzeros() > std::numeric_limits<std::uint32_t>::max()) {
    report.status = FactorStatus::failed;
    report.message = "this backend holds fewer than 2^32 entries";
    return report;
  }
  expected_ = -1;
  if (!p.multiplier.empty())
    expected_ = static_cast<Index>(std::count(p.multiplier.begin(), p.multiplier.end(), std::uint8_t{1}));
  pivoting_analyzed_ = false;
  tree_ = shared_front_tree(p, options_.ordering);
  begin_solve();
  single_.set_tree(*tree_);
  full_.set_tree(*tree_);
  narrow_.resize(n);
  copy_.resize(n);
  test_solution_.resize(n);
  // Without symmetry, so that it has a part along any direction.
  test_right_.resize(n);
  std::uint32_t state = 12345;
  for (double& b : test_right_) {
    state = state * 1664525u + 1013904223u;
    b = 0.5 + static_cast<double>(state >> 8) / double{1 << 24} * ((state >> 31) != 0u ? 1 : -1);
  }
  report.factor_nonzeros = tree_->panel_start.back();
  // In double precision: what may be needed.
  report.memory = 8.0 * static_cast<double>(tree_->panel_start.back() + tree_->workspace) +
                  static_cast<double>(tree_->entry.size()) * (sizeof(std::int64_t) + sizeof(std::uint32_t));
  return report;
}

FactorReport MultifrontalSolver::factor_values() {
  return factor_from(lowest_);
}

// Climbs until a rung is good enough.
FactorReport MultifrontalSolver::factor_from(Rung rung) {
  FactorReport report;
  report.factor_nonzeros = tree_->panel_start.back();
  for (rung_ = rung; rung_ != Rung::pivoting; rung_ = rung_ == Rung::single ? Rung::full : Rung::pivoting) {
    target_residual = rung_ == Rung::single ? enough_for_single : rounding_level;
    const bool whole = factor_fronts(report);
    if (interrupted()) {
      report.status = FactorStatus::interrupted;
      return report;
    }
    if (!whole) continue;
    reported_ = report.negative_pivots;
    lowest_ = std::max(lowest_, rung_);
    ++used_[static_cast<int>(rung_)];
    return report;
  }
  ++used_[static_cast<int>(Rung::pivoting)];
  report = factor_pivoting();
  reported_ = report.negative_pivots;
  return report;
}

bool MultifrontalSolver::factor_fronts(FactorReport& report) {
  const bool ok =
      rung_ == Rung::single
          ? single_.factor(loop_, values(), static_cast<float>(smallest_single * norm()), interrupt())
          : full_.factor(loop_, values(), smallest_double * norm(), interrupt());
  if (!ok) return false;
  report.negative_pivots = rung_ == Rung::single ? single_.negative_pivots() : full_.negative_pivots();
  return report.negative_pivots == expected_ || solves_well();
}

bool MultifrontalSolver::doubtful() const {
  return rung_ != Rung::pivoting && residual_ratio() > largest_ratio;
}

bool MultifrontalSolver::solves_well() {
  return refine(test_right_, test_solution_).ok && !doubtful();
}

FactorReport MultifrontalSolver::factor_pivoting() {
  FactorReport report;
  if (!pivoting_) {
    report.status = FactorStatus::singular;
    report.message = "the matrix is singular, or cannot be factored without pivoting";
    return report;
  }
  if (!pivoting_analyzed_) {
    report = pivoting_->analyze(pattern());
    if (report.status != FactorStatus::ok) return report;
    pivoting_analyzed_ = true;
  }
  return pivoting_->factor(values());
}

// Where refinement does not contract, on to the next rung; for good, as far as this solve of a saddle point
// goes.
bool MultifrontalSolver::strengthen(SolveReport& report) {
  if (rung_ == Rung::pivoting || interrupted()) return false;
  lowest_ = rung_ == Rung::single ? Rung::full : Rung::pivoting;
  const Index before = reported_;
  const FactorReport again = factor_from(lowest_);
  if (again.status != FactorStatus::ok) return false;
  report.inertia_changed = again.negative_pivots != before;
  return true;
}

bool MultifrontalSolver::apply_inverse(std::span<double> x) {
  if (rung_ == Rung::pivoting) {
    std::copy(x.begin(), x.end(), copy_.begin());
    return pivoting_->solve(copy_, x).ok;
  }
  if (rung_ == Rung::full) {
    full_.solve(x);
    return true;
  }
  // Single precision has a narrow range as well.
  double largest = 0;
  for (const double v : x) largest = std::max(largest, std::abs(v));
  if (largest == 0) return true;
  const double inverse = 1 / largest;
  if (!std::isfinite(inverse)) {
    std::fill(x.begin(), x.end(), 0.0);
    return true;
  }
  for (std::size_t i = 0; i < x.size(); ++i) narrow_[i] = static_cast<float>(x[i] * inverse);
  single_.solve(narrow_);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = largest * double{narrow_[i]};
  return true;
}

std::unique_ptr<LinearSolver> make_multifrontal_solver(std::unique_ptr<LinearSolver> pivoting,
                                                       const MultifrontalOptions& options) {
  return std::make_unique<MultifrontalSolver>(std::move(pivoting), options);
}

}  // namespace isochor
