#include "engine/solve/dual_ascent.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace isochor {

DualAscent::DualAscent(std::shared_ptr<const System> system, const Parallel& parallel,
                       std::unique_ptr<LinearSolver> solver, DualAscentOptions options)
    : SaddlePoint(std::move(system), parallel, std::move(solver)), ascent_(options) {
  const std::size_t n = at(system_->nodes()), m = at(system_->rows());
  for (auto* v : {&effective_, &direction_, &image_, &weights_}) v->assign(m, 0);
  if (ascent_.conjugate) {
    before_.assign(m, 0);
    image_before_.assign(m, 0);
  }
  for (auto* v : {&dx_, &rhs_, &x_trial_, &node_work_, &reaction_, &x_before_, &dx_before_}) v->resize(n);
}

// Evaluates at x with the multipliers lambda + W theta(x), projected: those of the augmented Lagrangian's
// gradient. Leaves theta for lambda itself.
void DualAscent::evaluate(const SaddleProblem& p, Want want, std::span<const Vec3> x,
                          std::span<const double> lambda) {
  const System& s = *system_;
  assembly_.evaluate(Want::value, Definiteness::exact, x, lambda, p.prescribed);
  row_residual(p, lambda);
  any_clamped_ = false;
  for (std::size_t r = 0; r < effective_.size(); ++r) {
    effective_[r] = lambda[r] + weights_[r] * theta_[r];
    if (!s.has_bounds()) continue;
    const double free = effective_[r];
    effective_[r] = std::clamp(free, s.row_lower()[r], s.row_upper()[r]);
    // Without weights the side of theta decides for a multiplier that sits at its bound.
    const double push = weights_[r] > 0 ? free : lambda[r] + theta_[r] / s.row_metric()[r];
    clamped_[r] = push <= s.row_lower()[r] || push >= s.row_upper()[r];
    any_clamped_ = any_clamped_ || clamped_[r];
  }
  if (want == Want::value) return;
  assembly_.evaluate(want, want == Want::hessian ? definiteness_ : Definiteness::exact, x, effective_,
                     p.prescribed);
  force_residual(p, x);
}

// The augmented Lagrangian at the last evaluation, up to a constant of lambda.
double DualAscent::lagrangian(const SaddleProblem& p, std::span<const Vec3> x,
                              std::span<const double> lambda) const {
  double sum = potential(p, x);
  for (std::size_t r = 0; r < theta_.size(); ++r) {
    const double up = effective_[r] - lambda[r];
    sum += effective_[r] * theta_[r];
    if (weights_[r] > 0) sum -= 0.5 * up * up / weights_[r];
  }
  return sum;
}

// Newton's method for the positions at fixed multipliers, until the forces balance to `tolerance`.
bool DualAscent::minimize(const SaddleProblem& p, const SaddleOptions& options, double tolerance,
                          std::span<Vec3> x, std::span<const double> lambda, SaddleReport& report) {
  const System& s = *system_;
  constexpr int most_failed_ventures = 3, most_returns = 4;
  struct {
    bool under_way = false;
    int failed = 0, returns = 0;
    double start = 0, slope = 0, longest = 0, enough = 0, excess = 0;
  } venture;
  double before = 0;
  bool whole = true;  // the last step
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    if (options.budget > 0 && report.iterations + report.corrections >= options.budget) break;
    if (report.factorizations >= options.max_factorizations ||
        (!whole && iteration >= options.patient_iterations) ||
        report.inner_work() >= options.most_inner_work())
      break;
    {
      const Stopwatch watch(seconds_.evaluate);
      evaluate(p, Want::hessian, x, lambda);
    }
    position_gap(p, x);
    const Residuals now = measure(p, x, lambda);
    if (factored_ && now.force <= tolerance && now.position <= options.position_tolerance) return true;
    if (interrupted()) {
      report.status = SaddleStatus::cancelled;
      return false;
    }
    // Factors at hand serve as long as a step with them takes most of the residual away.
    const bool reuse =
        factored_ && !has_gap_ && now.force < 1e-2 && (iteration == 0 || now.force < 0.3 * before);
    before = now.force;
    if (reuse) {
      ++report.corrections;
    } else {
      if (!s.laws().empty()) apply_laws(p, lambda, true);
      factored_ = factor(p, x, effective_, report);
      if (!factored_) {
        if (report.status == SaddleStatus::converged) report.status = SaddleStatus::singular;
        report.status = failed_as(report.status);
        return false;
      }
      ++report.iterations;
    }
    // Given coordinates move by their whole gap, the others follow: A dx = -(r + A gap).
    std::fill(node_work_.begin(), node_work_.end(), Vec3{});
    if (has_gap_) {
      assembly_.hessian_times(gap_, node_work_);
      add_inertia_of_gap(node_work_);
      assembly_.jacobian_times(gap_, image_);
      for (std::size_t r = 0; r < image_.size(); ++r)
        image_[r] *= any_clamped_ && clamped_[r] ? 0 : weights_[r];
      assembly_.constraint_force(image_, reaction_);
      for (std::size_t i = 0; i < node_work_.size(); ++i) node_work_[i] += reaction_[i];
    }
    for (std::size_t i = 0; i < r_.size(); ++i) rhs_[i] = -(r_[i] + node_work_[i]);
    bool solved = kkt_.solve_stiffness(rhs_, dx_, seconds_);
    if (!solved && kkt_.inertia_was_wrong())
      solved = factor(p, x, effective_, report) && kkt_.solve_stiffness(rhs_, dx_, seconds_);
    if (!solved) {
      report.status = failed_as(SaddleStatus::singular);
      return false;
    }
    double slope = 0, longest = 0;
    for (std::size_t i = 0; i < dx_.size(); ++i) {
      slope += dot(dx_[i], r_[i]);
      dx_[i] += gap_[i];
      longest = std::max(longest, norm(dx_[i]));
    }
    double start = lagrangian(p, x, lambda);
    const double noise = 1e-12 * (potential_magnitude(p, x) + std::abs(start));
    double tau = longest > 100 * s.length() ? 100 * s.length() / longest : 1;
    bool accepted = false;
    const Stopwatch watch(seconds_.line_search);
    const auto value_at = [&](double step) {
      ++report.trials;
      for (std::size_t i = 0; i < x.size(); ++i) x_trial_[i] = x[i] + step * dx_[i];
      evaluate(p, Want::gradient, x_trial_, lambda);
      return lagrangian(p, x_trial_, lambda);
    };
    if (venture.under_way) {
      // The step after one that was taken although its end was higher: held against where that one began.
      const double value = value_at(tau);
      const double left = value - venture.enough;
      if (left <= 0 || (left < 0.2 * venture.excess && ++venture.returns < most_returns)) {
        venture.under_way = left > 0;
        venture.excess = left;
        if (left <= 0) venture.failed = std::max(0, venture.failed - 1);
        std::copy(x_trial_.begin(), x_trial_.end(), x.begin());
        continue;
      }
      // Back to there, to backtrack along its direction.
      venture.under_way = false;
      ++venture.failed;
      std::copy(x_before_.begin(), x_before_.end(), x.begin());
      std::copy(dx_before_.begin(), dx_before_.end(), dx_.begin());
      start = venture.start;
      slope = venture.slope;
      longest = venture.longest;
      tau = 0.5;
    }
    for (int trial = 0; trial < 40 && tau > 1e-10 && !interrupted(); ++trial, tau *= 0.5) {
      const double value = value_at(tau);
      // Given coordinates on their way pump work in; then a finite energy and elements that stay whole do.
      accepted =
          std::isfinite(value) && (has_gap_ || value <= start + 1e-4 * tau * slope ||
                                   (std::abs(tau * slope) < 10 * noise && value <= start + 10 * noise));
      if (accepted) break;
      // Where backtracking would creep: what should turn was stretched on the tangent, stiff parts charge for
      // that, and the next step takes it back (Newton's ventures).
      const double curvature = value - start - slope;
      if (tau == 1 && std::isfinite(value) && -0.5 * slope < 0.1 * curvature && !mended_ && !reuse &&
          venture.failed < most_failed_ventures) {
        venture = {true, venture.failed, 0, start, slope, longest, start + 1e-4 * slope, value - start};
        std::copy(x.begin(), x.end(), x_before_.begin());
        std::copy(dx_.begin(), dx_.end(), dx_before_.begin());
        accepted = true;
        break;
      }
    }
    if (!accepted) {
      report.status = failed_as(SaddleStatus::line_search_failed);
      return false;
    }
    std::copy(x_trial_.begin(), x_trial_.end(), x.begin());
    report.step = tau * longest;
    whole = tau == 1;
    for (const Vec3& xi : x) {
      if (!finite(xi) || norm(xi - s.parts().rest[0]) > 1e4 * s.length()) {
        report.status = SaddleStatus::diverged;
        return false;
      }
    }
  }
  report.status = SaddleStatus::iteration_limit;
  return false;
}

// Takes from the direction its part along the last one, unless what is left does not climb any more (the
// gradient is in theta_): then the last one is forgotten.
void DualAscent::conjugate() {
  if (has_before_) {
    double across = 0, along = 0;
    for (std::size_t r = 0; r < direction_.size(); ++r) {
      across += direction_[r] * image_before_[r];
      along += before_[r] * image_before_[r];
    }
    const double part = along > 0 ? across / along : 0;
    double up = 0;
    for (std::size_t r = 0; r < direction_.size(); ++r)
      up += theta_[r] * (direction_[r] - (theta_[r] != 0 ? part * before_[r] : 0));
    if (up > 0) {
      // Rows held at a bound have no gradient and stay where they are.
      for (std::size_t r = 0; r < direction_.size(); ++r)
        if (theta_[r] != 0) direction_[r] -= part * before_[r];
    }
  }
  std::copy(direction_.begin(), direction_.end(), before_.begin());
  has_before_ = true;
}

// One step of the multipliers along the dual gradient T^T theta, of the length that maximizes the dual
// function's quadratic model (one solve with the factors at hand).
bool DualAscent::climb(std::span<double> lambda, SaddleReport& report) {
  const System& s = *system_;
  std::copy(theta_.begin(), theta_.end(), direction_.begin());
  for (std::size_t r = 0; r < direction_.size(); ++r)
    if (any_clamped_ && clamped_[r]) direction_[r] = 0;
  kkt_.weigh_transposed(direction_);
  double up = 0;
  std::copy(direction_.begin(), direction_.end(), theta_.begin());
  if (ascent_.scaled) {
    for (std::size_t r = 0; r < direction_.size(); ++r) direction_[r] /= kkt_.dual_preconditioner()[r];
  }
  if (ascent_.conjugate) conjugate();
  if (!kkt_.apply_dual(direction_, image_, seconds_)) return false;
  if (ascent_.conjugate) std::copy(image_.begin(), image_.end(), image_before_.begin());
  double curvature = 0, size = 0;
  for (std::size_t r = 0; r < direction_.size(); ++r) {
    up += direction_[r] * theta_[r];
    curvature += direction_[r] * image_[r];
    size += direction_[r] * kkt_.dual_preconditioner()[r] * direction_[r];
  }
  ++report.dual_steps;
  // Without curvature it is multipliers of rows that depend on each other, which do nothing.
  constexpr double no_curvature = 1e-13;
  const double omega = curvature > no_curvature * size ? up / curvature : 0;
  for (std::size_t r = 0; r < direction_.size(); ++r) {
    if (any_clamped_ && clamped_[r])
      lambda[r] = effective_[r];
    else
      lambda[r] += omega * direction_[r];
  }
  if (s.has_bounds()) clamp(lambda);
  return true;
}

SaddleReport DualAscent::solve(const SaddleProblem& p, const SaddleOptions& options, std::span<Vec3> x,
                               std::span<double> lambda) {
  const std::int64_t linear_before = kkt_.linear_iterations();
  SaddleReport report = ascend(p, options, x, lambda);
  report.linear_iterations = kkt_.linear_iterations() - linear_before;
  return report;
}

SaddleReport DualAscent::ascend(const SaddleProblem& p, const SaddleOptions& options, std::span<Vec3> x,
                                std::span<double> lambda) {
  const std::int64_t linear_before = kkt_.linear_iterations();
  SaddleReport report;
  if (!all_finite(p)) {
    report.status = SaddleStatus::not_finite;
    return report;
  }
  begin(p);
  factored_ = false;
  has_before_ = false;
  definiteness_ = options.definiteness;
  clamp(lambda);
  const System& s = *system_;
  if (ascent_.augmented && s.rows() > 0) {
    Kkt::Values values;
    if (!s.laws().empty()) apply_laws(p, lambda, true);
    values.tangent = tangent_;
    const auto w = kkt_.dual_weights(values);
    std::copy(w.begin(), w.end(), weights_.begin());
  }
  // The multipliers' steps converge linearly: many cheap ones, unless at their rate they cannot arrive.
  const int most = 20 * options.max_iterations;
  constexpr int window = 40;
  double tolerance = 1e-2, farther = std::numeric_limits<double>::infinity();
  for (int k = 0;; ++k) {
    assembly_.renew_lag(x, lambda, p.prescribed);
    assembly_.evaluate(Want::gradient, Definiteness::exact, x, lambda, p.prescribed);
    if (k == 0 && !std::isfinite(assembly_.energy())) {
      report.status = SaddleStatus::not_finite;
      return report;
    }
    assemble_residual(p, x, lambda);
    const bool done = balanced(p, options, x, lambda, report);
    if (!done && interrupted()) {
      report.status = SaddleStatus::cancelled;
      return report;
    }
    report.linear_iterations = kkt_.linear_iterations() - linear_before;
    tolerance = std::min(1e-2, 0.1 * report.force_residual);
    if (k > 0 && progress) progress(k, report.force_residual, report.row_residual);
    if (done) return report;
    const double left = std::max(report.force_residual / options.force_tolerance,
                                 report.row_residual / options.row_tolerance);
    bool too_slow = false;
    if (k > 0 && k % window == 0) {
      too_slow = left >= farther || std::log(left) / std::log(farther / left) * window > most - k;
      farther = left;
    }
    const bool spent = (options.budget > 0 && report.iterations + report.corrections >= options.budget) ||
                       report.inner_work() >= options.most_inner_work();
    if (k >= most || too_slow || spent) {
      report.status = SaddleStatus::iteration_limit;
      if (too_slow) report.message = "the multipliers converge too slowly";
      return report;
    }
    if (!minimize(p, options, std::max(0.1 * options.force_tolerance, tolerance), x, lambda, report))
      return report;
    if (s.rows() > 0 && !climb(lambda, report)) {
      report.status = failed_as(SaddleStatus::singular);
      return report;
    }
  }
}

}  // namespace isochor
