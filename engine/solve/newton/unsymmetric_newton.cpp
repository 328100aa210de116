#include "engine/solve/newton/unsymmetric_newton.h"

#include <algorithm>
#include <cmath>

namespace isochor {

UnsymmetricNewton::UnsymmetricNewton(std::shared_ptr<const System> system, const Parallel& parallel,
                                     std::unique_ptr<LinearSolver> solver,
                                     std::unique_ptr<LinearSolver> unsymmetric)
    : Newton(std::move(system), parallel, std::move(solver)) {
  kkt_.take_unsymmetric(std::move(unsymmetric));
  held_before_ = clamped_;
}

void UnsymmetricNewton::evaluate_here(const SaddleProblem& p, std::span<const Vec3> x,
                                      std::span<const double> lambda) {
  const Stopwatch watch(seconds_.evaluate);
  assembly_.renew_lag(x, lambda, p.prescribed);
  assembly_.evaluate(Want::hessian, definiteness_, x, lambda, p.prescribed);
  assemble_residual(p, x, lambda);
}

// R^2 of the last evaluation [J]; `gap_left` is the part of the gaps of given nodes that is still open.
double UnsymmetricNewton::residual_energy(std::span<const double> lambda, double gap_left) const {
  const System& s = *system_;
  double sum = 0;
  for (Index i = 0; i < s.nodes(); ++i) {
    const double k = stiffness_[at(i)];
    if (k <= 0) continue;
    const Index b = s.basis_of()[at(i)];
    if (b < 0) {
      sum += dot(r_[at(i)], r_[at(i)]) / k;
      continue;
    }
    const FreeBasis& basis = s.free_bases()[at(b)];
    const Vec3 q = transposed_times(basis.directions, r_[at(i)]);
    for (int c = 0; c < basis.count; ++c) sum += q[c] * q[c] / k;
    sum += gap_left * gap_left * k * dot(gap_[at(i)], gap_[at(i)]);
  }
  for (std::size_t r = 0; r < theta_.size(); ++r) {
    const double d = s.row_metric()[r];
    double left = theta_[r] / d;
    if (s.has_bounds()) left = std::clamp(lambda[r] + left, s.row_lower()[r], s.row_upper()[r]) - lambda[r];
    sum += d * left * left;
  }
  return std::isfinite(assembly_.energy()) ? sum : std::numeric_limits<double>::infinity();
}

bool UnsymmetricNewton::factor_coupled(SaddleReport& report) {
  for (;;) {
    Kkt::Values values;
    values.mass_scale = mass_scale_;
    values.stiffness = stiffness_;
    values.tangent = tangent_;
    if (any_clamped_) values.clamped = clamped_;
    values.trace = trace_;
    values.unsymmetric = &*part_;
    const Kkt::Outcome f = kkt_.factor(assembly_, values, seconds_);
    ++report.factorizations;
    report.negative_pivots = -1;
    if (f.status == FactorStatus::ok) return true;
    report.message = f.message;
    // As in SaddlePoint::factor(): rows with bounds may repeat each other.
    if (f.status != FactorStatus::singular || !system_->has_bounds() || trace_ > 0) return false;
    trace_ = 1e-8;
  }
}

// The direction of the unsymmetric system: on the factors of its symmetric part, which cost a quarter, as
// long as these do in this solve.
bool UnsymmetricNewton::find_coupled(std::span<const double> lambda, SaddleReport& report) {
  if (!factors_alone_) {
    coupling_ = Coupling::added;
    // As exact as a quadratic end asks for.
    coupled_tolerance_ = std::clamp(0.01 * std::max(report.force_residual, report.row_residual), 1e-9, 1e-3);
    factor_shifted(mass_scale_, 0, report);
    report.negative_pivots = -1;
    if (!singular_ && direction(lambda, report)) return true;
    factors_alone_ = true;
  }
  coupling_ = Coupling::factored;
  return factor_coupled(report) && direction(lambda, report);
}

// One iteration with the unsymmetric matrix; false when it finds no smaller residual.
bool UnsymmetricNewton::coupled_step(const SaddleProblem& p, const SaddleOptions& options, std::span<Vec3> x,
                                     std::span<double> lambda, SaddleReport& report) {
  constexpr double shortest = 0.4;
  mended_ = false;
  const bool found = find_coupled(lambda, report);
  ++report.iterations;
  if (!found) return false;
  const double start = residual_energy(lambda, 1);
  double longest = 0;
  for (const Vec3& d : dx_) longest = std::max(longest, norm(d));
  double tau = longest > 100 * system_->length() ? 100 * system_->length() / longest : 1;
  tau = longest_step(tau);
  for (const double least = shortest * tau; tau >= least;) {
    try_coupled(p, tau, x, lambda, report);
    const double value = residual_energy(lambda_trial_, 1 - tau);
    if (value <= (1 - 2e-4 * tau) * start || balanced(p, options, x_trial_, lambda_trial_, report)) {
      std::copy(x_trial_.begin(), x_trial_.end(), x.begin());
      std::copy(lambda_trial_.begin(), lambda_trial_.end(), lambda.begin());
      report.step = tau * longest;
      full_step_ = tau == 1;
      return true;
    }
    // The parabola through the start, where R^2 falls by 2 R^2, and here.
    const double bend = value - start + 2 * start * tau;
    tau *= std::isfinite(value) ? std::clamp(start * tau / bend, 0.2, 0.5) : 0.5;
  }
  return false;
}

// One iteration as Newton makes it, from an evaluation at x.
bool UnsymmetricNewton::lagged_step(const SaddleProblem& p, std::span<Vec3> x, std::span<double> lambda,
                                    SaddleReport& report) {
  coupling_ = Coupling::none;
  if (!factor(p, x, lambda, report)) {
    if (report.status == SaddleStatus::converged) report.status = SaddleStatus::singular;
    return false;
  }
  bool found = direction(lambda, report);
  if (report.negative_pivots < 0 && !(found && descends(p, x, lambda)))
    found = mend_direction(p, x, lambda, report);
  if (!found) {
    report.status = SaddleStatus::singular;
    return false;
  }
  ++report.iterations;
  if (search(p, x, lambda, report)) return true;
  report.status = SaddleStatus::line_search_failed;
  return false;
}

bool UnsymmetricNewton::polish(const SaddleProblem& p, const SaddleOptions& options, std::span<Vec3> x,
                               std::span<double> lambda, SaddleReport& report) {
  coupled_tolerance_ = correction_tolerance;
  return options.corrections && full_step_ && close_enough(report) &&
         correct_coupled(p, options, x, lambda, report);
}

SaddleReport UnsymmetricNewton::solve(const SaddleProblem& p, const SaddleOptions& options, std::span<Vec3> x,
                                      std::span<double> lambda) {
  SaddleReport report;
  const auto fail = [&](SaddleStatus status) {
    report.status = failed_as(status);
    return report;
  };
  if (!all_finite(p)) return fail(SaddleStatus::not_finite);
  begin(p);
  begin_search(options);
  clamp(lambda);
  const System& s = *system_;
  constexpr int longest_hold = 8;
  bool holding = false;
  int stalls = 0, held = 0;  // iterations with the lag held since the last stall
  full_step_ = false;
  factors_alone_ = !kkt_.coupled_possible();
  for (int iteration = 0;; ++iteration) {
    evaluate_here(p, x, lambda);
    if (iteration == 0 && !std::isfinite(assembly_.energy())) return fail(SaddleStatus::not_finite);
    position_gap(p, x);
    if (interrupted()) return fail(SaddleStatus::cancelled);
    if (report.iterations >= std::min(options.max_iterations, options.patient_iterations) ||
        report.factorizations >= std::min(options.max_factorizations, options.patient_factorizations))
      return fail(SaddleStatus::iteration_limit);
    if (balanced(p, options, x, lambda, report)) return report;
    if (s.has_bounds()) choose_clamped(lambda, iteration == 0);
    if (!s.laws().empty()) apply_laws(p, lambda, true);
    const bool settled = full_step_ && clamped_ == held_before_;
    std::copy(clamped_.begin(), clamped_.end(), held_before_.begin());
    if (holding && held >= stalls && (settled || held >= longest_hold)) holding = false;
    part_->evaluate(assembly_, x);
    if (part_->vanishes()) {
      if (!lagged_step(p, x, lambda, report)) return fail(report.status);
    } else if (holding || !coupled_step(p, options, x, lambda, report)) {
      // The step that failed was one.
      if (report.iterations >= options.max_iterations) return fail(SaddleStatus::iteration_limit);
      if (!holding) {
        holding = true;
        held = 0;
        ++stalls;
        evaluate_here(p, x, lambda);
        if (!s.laws().empty()) apply_laws(p, lambda, true);
      }
      ++held;
      ++report.lagged;
      if (!lagged_step(p, x, lambda, report)) return fail(report.status);
    }
    const bool done = balanced(p, options, x, lambda, report);
    if (progress) progress(report.iterations, report.force_residual, report.row_residual);
    // With the lag held, balance counts only once it is renewed.
    if (coupling_ == Coupling::none ? correct(p, options, x, lambda, report)
                                    : done || polish(p, options, x, lambda, report))
      return report;
    if (left_all_bounds(x)) return fail(SaddleStatus::diverged);
  }
}

}  // namespace isochor
