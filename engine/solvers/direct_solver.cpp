#include "engine/solvers/direct_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "engine/base/base.h"
#include "engine/solvers/pattern_check.h"

namespace isochor {
namespace {

// Below, rounding has a say in how residuals go on.
constexpr double near_rounding = 1e-12;
// A solution is usable when it solves a system this close to the one given.
constexpr double acceptable_residual = 1e-10;

// Infinity norm that does not lose a NaN, as std::max would.
double max_norm(std::span<const double> v) {
  double largest = 0, poison = 0;
  for (const double x : v) {
    largest = std::max(largest, std::abs(x));
    poison += x * 0.0;
  }
  return largest + poison;
}

}  // namespace

FactorReport DirectSolver::analyze(const SymmetricPattern& pattern) {
  factored_ = false;
  pattern_ = nullptr;
  FactorReport report;
  try {
    report.message = check(pattern);
    if (!report.message.empty()) {
      report.status = FactorStatus::failed;
      return report;
    }
    const auto n = at(pattern.size);
    residual_.assign(n, 0);
    correction_.assign(n, 0);
    best_.assign(n, 0);
    pattern_ = &pattern;
    if (n > 0) report = analyze_pattern();
  } catch (const std::bad_alloc&) {
    report.status = FactorStatus::out_of_memory;
  } catch (...) {
    report.status = FactorStatus::failed;
  }
  if (report.status != FactorStatus::ok) pattern_ = nullptr;
  return report;
}

FactorReport DirectSolver::factor(std::span<const double> values) {
  factored_ = proven_ = false;
  FactorReport report;
  try {
    const std::size_t triangles = two_triangles_ ? 2 : 1;
    if (pattern_ == nullptr || values.size() != triangles * static_cast<std::size_t>(pattern_->nonzeros())) {
      report.status = FactorStatus::failed;
      report.message = pattern_ == nullptr ? "factor was called without a successful analyze"
                                           : "the number of values is not that of the analyzed pattern";
      return report;
    }
    values_ = values;
    if (pattern_->size == 0) {
      report.negative_pivots = 0;
      factored_ = true;
      return report;
    }
    norm_ = matrix_norm(*pattern_, values, residual_);
    if (!std::isfinite(norm_)) {
      report.status = FactorStatus::not_finite;
      report.message = "the matrix has a value that is not finite, or too large to sum";
      return report;
    }
    report = factor_values();
  } catch (const std::bad_alloc&) {
    report.status = FactorStatus::out_of_memory;
  } catch (...) {
    report.status = FactorStatus::failed;
  }
  factored_ = report.status == FactorStatus::ok;
  return report;
}

SolveReport DirectSolver::solve_to(double tolerance, std::span<const double> right_hand_side,
                                   std::span<double> solution) {
  SolveReport report;
  report.residual = std::numeric_limits<double>::infinity();
  const std::size_t n = pattern_ == nullptr ? 0 : at(pattern_->size);
  if (factored_ && right_hand_side.size() == n && solution.size() == n) {
    if (n == 0) return {true, 0, 0};
    try {
      if (std::isfinite(max_norm(right_hand_side)))
        report = refine_as_needed(right_hand_side, solution, tolerance);
    } catch (const std::bad_alloc&) {
      throw;  // says nothing about the matrix
    } catch (...) {
      report.ok = false;
    }
  }
  // Whatever went wrong, no NaN leaves here.
  if (!std::isfinite(report.residual)) std::fill(solution.begin(), solution.end(), 0.0);
  return report;
}

bool DirectSolver::precondition(std::span<double> x) {
  if (!factored_ || x.size() != at(pattern_->size)) return false;
  try {
    return x.empty() || apply_inverse(x);
  } catch (...) {
    return false;
  }
}

SolveReport DirectSolver::refine_as_needed(std::span<const double> b, std::span<double> x, double tolerance) {
  bool inertia_changed = false;
  SolveReport report = refine(b, x, tolerance);
  while ((!report.ok || doubtful()) && strengthen(report)) {
    inertia_changed = inertia_changed || report.inertia_changed;
    proven_ = false;
    report = refine(b, x, tolerance);
  }
  report.inertia_changed = inertia_changed;
  // Solved, but not what was asked for: whoever asked believes in another inertia.
  if (inertia_changed) report.ok = false;
  return report;
}

SolveReport DirectSolver::refine(std::span<const double> b, std::span<double> x, double tolerance) {
  SolveReport report;
  report.residual = std::numeric_limits<double>::infinity();
  residual_ratio_ = 0;
  const double b_norm = max_norm(b);
  std::copy(b.begin(), b.end(), x.begin());
  if (!apply_inverse(x)) return report;
  const auto relative = [&](std::span<const double> y) {
    residual_norm_ = compute_residual(b, y);
    const double scale = norm_ * max_norm(y) + b_norm;
    return scale > 0 ? residual_norm_ / scale : residual_norm_;
  };
  // Of new factors one refinement is asked for, whatever the tolerance: whether it contracts tells what they
  // are worth.
  const auto arrived = [&] {
    return residual_norm_ <= tolerance * b_norm && (proven_ || report.refinements > 0);
  };
  report.residual = relative(x);
  while (report.residual > target_residual && !arrived() && report.refinements < max_refinements &&
         std::isfinite(report.residual)) {
    const double before = report.residual, norm_before = residual_norm_;
    std::copy(residual_.begin(), residual_.end(), correction_.begin());
    if (!apply_inverse(correction_)) break;
    std::copy(x.begin(), x.end(), best_.begin());
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += correction_[i];
    const double now = relative(x);
    ++report.refinements;
    if (before > near_rounding) residual_ratio_ = std::max(residual_ratio_, residual_norm_ / norm_before);
    if (!(now < before)) {  // worse, or NaN: keep what was there
      std::copy(best_.begin(), best_.end(), x.begin());
      residual_norm_ = norm_before;
      break;
    }
    report.residual = now;
    if (now > 0.5 * before) break;
  }
  report.ok = report.residual <= acceptable_residual || arrived();
  proven_ = proven_ || report.ok;
  return report;
}

double DirectSolver::compute_residual(std::span<const double> b, std::span<const double> x) {
  const double* const v = values_.data();
  const double* const upper = two_triangles_ ? v + pattern_->nonzeros() : v;
  const Index* const row = pattern_->row.data();
  const std::int64_t* const start = pattern_->column_start.data();
  double* const r = residual_.data();
  std::copy(b.begin(), b.end(), residual_.begin());
  for (Index c = 0; c < pattern_->size; ++c) {
    const double xc = x[at(c)];
    double sum = 0;
    for (auto k = start[c]; k < start[c + 1]; ++k) {
      const Index i = row[k];
      if (i == c) {
        sum += v[k] * xc;
      } else {
        r[i] -= v[k] * xc;
        sum += upper[k] * x[at(i)];
      }
    }
    r[c] -= sum;
  }
  return max_norm(residual_);
}

}  // namespace isochor
