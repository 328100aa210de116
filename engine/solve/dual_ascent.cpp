#include "engine/solve/dual_ascent.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/solve/watchdog.h"

namespace isochor {

// The minimization of the positions on its way.
struct DualAscent::Descent {
  Watchdog watchdog;
  double force = 0;    // residual at the last iterate
  bool reuse = false;  // of factors at hand
  bool whole = true;   // the last step
  double slope = 0, longest = 0;
  double start = 0;  // the Lagrangian where the step begins
  double noise = 0;
  // Where the watchdog's step began.
  double watched_start = 0, watched_slope = 0, watched_longest = 0;
};

DualAscent::DualAscent(std::shared_ptr<const System> system, const Parallel& parallel,
                       std::unique_ptr<LinearSolver> solver, DualAscentOptions options)
    : SaddlePoint(system, parallel, std::move(solver)), ascent_(options) {
  const std::size_t n = at(system->nodes()), m = at(system->rows());
  for (auto* v : {&effective_, &direction_, &image_, &gradient_, &weights_}) v->assign(m, 0);
  if (system->has_bounds()) held_.assign(m, 0);
  if (ascent_.conjugate) {
    before_.assign(m, 0);
    image_before_.assign(m, 0);
  }
  for (auto* v : {&dx_, &rhs_, &node_work_, &reaction_, &x_before_, &dx_before_}) v->resize(n);
}

// Evaluates at the iterate with the multipliers lambda + W theta(x), projected: those of the augmented
// Lagrangian's gradient. Leaves theta for lambda itself.
void DualAscent::evaluate(const SaddleProblem& p, Want want, Iterate& it) {
  const System& s = system();
  slots().evaluate(Want::value, Definiteness::exact, it.x, it.lambda, p.prescribed);
  evaluator_.read_rows(p, it);
  any_held_ = false;
  for (std::size_t r = 0; r < effective_.size(); ++r) {
    effective_[r] = it.lambda[r] + weights_[r] * it.theta[r];
    if (!s.has_bounds()) continue;
    const double free = effective_[r];
    effective_[r] = std::clamp(free, s.row_lower()[r], s.row_upper()[r]);
    // Without weights the side of theta decides for a multiplier that sits at its bound.
    const double push = weights_[r] > 0 ? free : it.lambda[r] + it.theta[r] / s.row_metric()[r];
    held_[r] = push <= s.row_lower()[r] || push >= s.row_upper()[r];
    any_held_ = any_held_ || held_[r];
  }
  matrix_.hold(any_held_ ? std::span<const std::uint8_t>(held_) : std::span<const std::uint8_t>());
  slots().evaluate(want, want == Want::hessian ? matrix_.definiteness() : Definiteness::exact, it.x,
                   effective_, p.prescribed);
  evaluator_.read_forces(p, it);
}

// The augmented Lagrangian at the last evaluation, which was here, up to a constant of lambda.
double DualAscent::lagrangian(const SaddleProblem& p, const Iterate& it) const {
  double sum = evaluator_.potential(p, it);
  for (std::size_t r = 0; r < it.theta.size(); ++r) {
    const double up = effective_[r] - it.lambda[r];
    sum += effective_[r] * it.theta[r];
    if (weights_[r] > 0) sum -= 0.5 * up * up / weights_[r];
  }
  return sum;
}

double DualAscent::value_at(const SaddleProblem& p, double tau, SaddleReport& report) {
  ++report.trials;
  for (std::size_t i = 0; i < now_.x.size(); ++i) trial_.x[i] = now_.x[i] + tau * dx_[i];
  evaluate(p, Want::gradient, trial_);
  return lagrangian(p, trial_);
}

bool DualAscent::left_all_bounds() const {
  const System& s = system();
  return !std::all_of(now_.x.begin(), now_.x.end(), [&](const Vec3& xi) {
    return finite(xi) && norm(xi - s.parts().rest[0]) <= 1e4 * s.length();
  });
}

bool DualAscent::spent(const SaddleOptions& o, const Descent& d, int iteration,
                       const SaddleReport& report) const {
  if (o.budget > 0 && report.iterations + report.corrections >= o.budget) return true;
  return report.factorizations >= o.max_factorizations || (!d.whole && iteration >= o.patient_iterations) ||
         report.inner_work() >= o.most_inner_work();
}

// The Newton step of the positions: given coordinates move by their whole gap, the others follow, A dx =
// -(r + A gap). Where factors at hand do not serve, new ones.
bool DualAscent::direction(const SaddleProblem& p, Descent& d, SaddleReport& report) {
  if (d.reuse) {
    ++report.corrections;
  } else {
    if (!system().laws().empty()) evaluator_.apply_laws(p, now_.lambda, true);
    factored_ = matrix_.factor(p, now_.x, effective_, report);
    if (!factored_) {
      if (report.status == SaddleStatus::converged) report.status = SaddleStatus::singular;
      report.status = failed_as(report.status);
      return false;
    }
    ++report.iterations;
  }
  std::fill(node_work_.begin(), node_work_.end(), Vec3{});
  if (gap_.open) {
    slots().hessian_times(gap_.way, node_work_);
    evaluator_.add_inertia_of_gap(gap_, node_work_);
    slots().jacobian_times(gap_.way, image_);
    for (std::size_t r = 0; r < image_.size(); ++r) image_[r] *= any_held_ && held_[r] ? 0 : weights_[r];
    slots().constraint_force(image_, reaction_);
    for (std::size_t i = 0; i < node_work_.size(); ++i) node_work_[i] += reaction_[i];
  }
  for (std::size_t i = 0; i < now_.force.size(); ++i) rhs_[i] = -(now_.force[i] + node_work_[i]);
  bool solved = kkt_.solve_stiffness(rhs_, dx_, seconds_);
  if (!solved && kkt_.inertia_was_wrong())
    solved = matrix_.factor(p, now_.x, effective_, report) && kkt_.solve_stiffness(rhs_, dx_, seconds_);
  if (!solved) {
    report.status = failed_as(SaddleStatus::singular);
    return false;
  }
  d.slope = d.longest = 0;
  for (std::size_t i = 0; i < dx_.size(); ++i) {
    d.slope += dot(dx_[i], now_.force[i]);
    dx_[i] += gap_.way[i];
    d.longest = std::max(d.longest, norm(dx_[i]));
  }
  return true;
}

bool DualAscent::backtrack(const SaddleProblem& p, Descent& d, double tau, SaddleReport& report) {
  constexpr int most_trials = 40;
  constexpr double shortest = 1e-10;
  for (int trial = 0; trial < most_trials && tau > shortest && !interrupted(); ++trial, tau *= 0.5) {
    const double value = value_at(p, tau, report);
    const double enough = d.start + 1e-4 * tau * d.slope;
    // Given coordinates on their way pump work in; then a finite energy and elements that stay whole do.
    bool accepted =
        std::isfinite(value) && (gap_.open || value <= enough ||
                                 (std::abs(tau * d.slope) < 10 * d.noise && value <= d.start + 10 * d.noise));
    // Where backtracking would creep.
    const double curvature = value - d.start - d.slope;
    if (!accepted && tau == 1 && std::isfinite(value) && -0.5 * d.slope < 0.1 * curvature &&
        !matrix_.mended() && !d.reuse && d.watchdog.may_begin()) {
      d.watchdog.begin(d.start + 1e-4 * d.slope, value - d.start);
      d.watched_start = d.start;
      d.watched_slope = d.slope;
      d.watched_longest = d.longest;
      std::copy(now_.x.begin(), now_.x.end(), x_before_.begin());
      std::copy(dx_.begin(), dx_.end(), dx_before_.begin());
      accepted = true;
    }
    if (!accepted) continue;
    std::swap(now_.x, trial_.x);
    report.step = tau * d.longest;
    d.whole = tau == 1;
    return true;
  }
  report.status = failed_as(SaddleStatus::line_search_failed);
  return false;
}

// Moves now_.x along the direction; false: the report says why not.
bool DualAscent::search(const SaddleProblem& p, Descent& d, SaddleReport& report) {
  const System& s = system();
  const Stopwatch watch(seconds_.line_search);
  d.start = lagrangian(p, now_);
  d.noise = 1e-12 * (evaluator_.potential_magnitude(p, now_) + std::abs(d.start));
  double tau = d.longest > 100 * s.length() ? 100 * s.length() / d.longest : 1;
  if (d.watchdog.watching()) {
    if (d.watchdog.judge(value_at(p, tau, report)) != Watchdog::Outcome::failed) {
      std::swap(now_.x, trial_.x);
      return true;
    }
    // Back to where it began, to backtrack along its direction.
    std::copy(x_before_.begin(), x_before_.end(), now_.x.begin());
    std::copy(dx_before_.begin(), dx_before_.end(), dx_.begin());
    d.start = d.watched_start;
    d.slope = d.watched_slope;
    d.longest = d.watched_longest;
    tau = 0.5;
  }
  if (!backtrack(p, d, tau, report)) return false;
  if (left_all_bounds()) report.status = SaddleStatus::diverged;
  return report.status == SaddleStatus::converged;
}

// Newton's method for the positions at fixed multipliers, until the forces balance to `tolerance`.
bool DualAscent::minimize(const SaddleProblem& p, const SaddleOptions& options, double tolerance,
                          SaddleReport& report) {
  Descent d;
  trial_.lambda = now_.lambda;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    if (spent(options, d, iteration, report)) break;
    {
      const Stopwatch watch(seconds_.evaluate);
      evaluate(p, Want::hessian, now_);
    }
    evaluator_.find_gap(p, now_.x, gap_);
    const Evaluator::Residuals now = evaluator_.measure(p, now_);
    if (factored_ && now.force <= tolerance && now.position <= options.position_tolerance) return true;
    if (interrupted()) {
      report.status = SaddleStatus::cancelled;
      return false;
    }
    // Factors at hand serve as long as a step with them takes most of the residual away.
    d.reuse = factored_ && !gap_.open && now.force < 1e-2 && (iteration == 0 || now.force < 0.3 * d.force);
    d.force = now.force;
    if (!direction(p, d, report) || !search(p, d, report)) return false;
  }
  report.status = SaddleStatus::iteration_limit;
  return false;
}

// Takes from the direction its part along the last one, unless what is left does not climb any more (the
// gradient is in gradient_): then the last one is forgotten.
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
      up += gradient_[r] * (direction_[r] - (gradient_[r] != 0 ? part * before_[r] : 0));
    if (up > 0) {
      // Rows held at a bound have no gradient and stay where they are.
      for (std::size_t r = 0; r < direction_.size(); ++r)
        if (gradient_[r] != 0) direction_[r] -= part * before_[r];
    }
  }
  std::copy(direction_.begin(), direction_.end(), before_.begin());
  has_before_ = true;
}

// The ascent's direction: the dual gradient T^T theta, in units of the row metric where it is scaled.
void DualAscent::find_climb() {
  std::copy(now_.theta.begin(), now_.theta.end(), direction_.begin());
  for (std::size_t r = 0; r < direction_.size(); ++r)
    if (any_held_ && held_[r]) direction_[r] = 0;
  kkt_.weigh_transposed(direction_);
  std::copy(direction_.begin(), direction_.end(), gradient_.begin());
  if (ascent_.scaled) {
    for (std::size_t r = 0; r < direction_.size(); ++r) direction_[r] /= kkt_.dual_preconditioner()[r];
  }
  if (ascent_.conjugate) conjugate();
}

// One step of the multipliers along it, of the length that maximizes the dual function's quadratic model (one
// solve with the factors at hand).
bool DualAscent::climb(SaddleReport& report) {
  find_climb();
  if (!kkt_.apply_dual(direction_, image_, seconds_)) return false;
  if (ascent_.conjugate) std::copy(image_.begin(), image_.end(), image_before_.begin());
  double up = 0, curvature = 0, size = 0;
  for (std::size_t r = 0; r < direction_.size(); ++r) {
    up += direction_[r] * gradient_[r];
    curvature += direction_[r] * image_[r];
    size += direction_[r] * kkt_.dual_preconditioner()[r] * direction_[r];
  }
  ++report.dual.steps;
  // Without curvature it is multipliers of rows that depend on each other, which do nothing.
  constexpr double no_curvature = 1e-13;
  const double omega = curvature > no_curvature * size ? up / curvature : 0;
  for (std::size_t r = 0; r < direction_.size(); ++r) {
    if (any_held_ && held_[r])
      now_.lambda[r] = effective_[r];
    else
      now_.lambda[r] += omega * direction_[r];
  }
  if (system().has_bounds()) evaluator_.clamp(now_.lambda);
  return true;
}

SaddleReport DualAscent::solve_from_here(const SaddleProblem& p, const SaddleOptions& options) {
  const std::int64_t linear_before = kkt_.linear_iterations();
  SaddleReport report = ascend(p, options);
  report.krylov.iterations = kkt_.linear_iterations() - linear_before;
  return report;
}

SaddleReport DualAscent::ascend(const SaddleProblem& p, const SaddleOptions& options) {
  const std::int64_t linear_before = kkt_.linear_iterations();
  SaddleReport report;
  const auto fail = [&](SaddleStatus status) {
    report.status = status;
    return report;
  };
  factored_ = false;
  has_before_ = false;
  const System& s = system();
  if (ascent_.augmented && s.rows() > 0) {
    Kkt::Values values;
    if (!s.laws().empty()) evaluator_.apply_laws(p, now_.lambda, true);
    values.tangent = evaluator_.tangents();
    const auto w = kkt_.dual_weights(values);
    std::copy(w.begin(), w.end(), weights_.begin());
  }
  // The multipliers' steps converge linearly: many cheap ones, unless at their rate they cannot arrive.
  const int most = 20 * options.max_iterations;
  constexpr int window = 40;
  constexpr double loosest = 1e-2;
  double farther = std::numeric_limits<double>::infinity();
  for (int k = 0;; ++k) {
    evaluator_.renew_lag(p, now_);
    evaluator_.evaluate(p, Want::gradient, Definiteness::exact, now_);
    if (k == 0 && !std::isfinite(now_.energy)) return fail(SaddleStatus::not_finite);
    const bool done = evaluator_.balanced(p, options, now_, report);
    if (!done && interrupted()) return fail(SaddleStatus::cancelled);
    report.krylov.iterations = kkt_.linear_iterations() - linear_before;
    if (k > 0 && progress) progress(k, report.force_residual, report.row_residual);
    if (done) return report;
    const double left = std::max(report.force_residual / options.force_tolerance,
                                 report.row_residual / options.row_tolerance);
    bool too_slow = false;
    if (k > 0 && k % window == 0) {
      too_slow = left >= farther || std::log(left) / std::log(farther / left) * window > most - k;
      farther = left;
    }
    if (too_slow) report.message = "the multipliers converge too slowly";
    const bool out_of_budget =
        (options.budget > 0 && report.iterations + report.corrections >= options.budget) ||
        report.inner_work() >= options.most_inner_work();
    if (k >= most || too_slow || out_of_budget) return fail(SaddleStatus::iteration_limit);
    const double tolerance = std::min(loosest, 0.1 * report.force_residual);
    if (!minimize(p, options, std::max(0.1 * options.force_tolerance, tolerance), report)) {
      // Whoever keeps the last iterate asks what is there.
      evaluator_.evaluate(p, Want::gradient, Definiteness::exact, now_);
      return report;
    }
    if (s.rows() > 0 && !climb(report)) return fail(failed_as(SaddleStatus::singular));
  }
}

}  // namespace isochor
