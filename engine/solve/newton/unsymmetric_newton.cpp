#include "engine/solve/newton/unsymmetric_newton.h"

#include <algorithm>
#include <cmath>

namespace isochor {

UnsymmetricNewton::UnsymmetricNewton(std::shared_ptr<const System> system, const Parallel& parallel,
                                     std::unique_ptr<LinearSolver> solver,
                                     std::unique_ptr<LinearSolver> unsymmetric)
    : Newton(std::move(system), parallel, std::move(solver)) {
  kkt_.take_unsymmetric(std::move(unsymmetric));
  held_before_ = held_.held;
}

// R^2 of an iterate [J]; `gap_left` is the part of the gaps of given nodes that is still open.
double UnsymmetricNewton::residual_energy(const Iterate& it, double gap_left) const {
  const System& s = system();
  const auto stiffness = evaluator_.stiffness();
  double sum = 0;
  for (Index i = 0; i < s.nodes(); ++i) {
    const double k = stiffness[at(i)];
    if (k <= 0) continue;
    const Index b = s.basis_of()[at(i)];
    if (b < 0) {
      sum += dot(it.force[at(i)], it.force[at(i)]) / k;
      continue;
    }
    const FreeBasis& basis = s.free_bases()[at(b)];
    const Vec3 q = transposed_times(basis.directions, it.force[at(i)]);
    for (int c = 0; c < basis.count; ++c) sum += q[c] * q[c] / k;
    sum += gap_left * gap_left * k * dot(gap_.way[at(i)], gap_.way[at(i)]);
  }
  for (std::size_t r = 0; r < it.theta.size(); ++r) {
    const double d = s.row_metric()[r];
    double left = it.theta[r] / d;
    if (s.has_bounds())
      left = std::clamp(it.lambda[r] + left, s.row_lower()[r], s.row_upper()[r]) - it.lambda[r];
    sum += d * left * left;
  }
  return std::isfinite(it.energy) ? sum : std::numeric_limits<double>::infinity();
}

// The direction of the unsymmetric system: on the factors of its symmetric part, which cost a quarter, as
// long as these do in this solve.
bool UnsymmetricNewton::find_coupled(SaddleReport& report) {
  if (!factors_alone_) {
    coupling_ = Coupling::added;
    // As exact as a quadratic end asks for.
    coupled_tolerance_ = std::clamp(0.01 * std::max(report.force_residual, report.row_residual), 1e-9, 1e-3);
    matrix_.factor_exact(report);
    report.negative_pivots = -1;
    if (!matrix_.singular() && direction(report)) return true;
    factors_alone_ = true;
  }
  coupling_ = Coupling::factored;
  return matrix_.factor_unsymmetric(*part_, report) && direction(report);
}

// One iteration with the unsymmetric matrix; false when it finds no smaller residual.
bool UnsymmetricNewton::coupled_step(const SaddleProblem& p, const SaddleOptions& options,
                                     SaddleReport& report) {
  constexpr double shortest = 0.4;
  const bool found = find_coupled(report);
  ++report.iterations;
  if (!found) return false;
  const double start = residual_energy(now_, 1);
  double longest = 0;
  for (const Vec3& d : step_.dx) longest = std::max(longest, norm(d));
  const double reach = 100 * system().length();
  double tau = longest_step(longest > reach ? reach / longest : 1);
  for (const double least = shortest * tau; tau >= least;) {
    try_coupled(p, tau, report);
    const double value = residual_energy(trial_, 1 - tau);
    if (value <= (1 - 2e-4 * tau) * start || evaluator_.balanced(p, options, trial_, report)) {
      std::swap(now_, trial_);
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

// One iteration as Newton makes it, from an evaluation at now_.
bool UnsymmetricNewton::lagged_step(const SaddleProblem& p, SaddleReport& report) {
  coupling_ = Coupling::none;
  if (!matrix_.factor(p, now_.x, now_.lambda, report)) {
    if (report.status == SaddleStatus::converged) report.status = SaddleStatus::singular;
    return false;
  }
  bool found = direction(report);
  if (report.negative_pivots < 0 && !(found && descends(p))) found = mend_direction(p, report);
  if (!found) {
    report.status = SaddleStatus::singular;
    return false;
  }
  ++report.iterations;
  if (search(p, report)) return true;
  report.status = SaddleStatus::line_search_failed;
  return false;
}

bool UnsymmetricNewton::polish(const SaddleProblem& p, const SaddleOptions& options, SaddleReport& report) {
  coupled_tolerance_ = correction_tolerance;
  return options.corrections && full_step_ && close_enough(report) && correct_coupled(p, options, report);
}

SaddleReport UnsymmetricNewton::solve_from_here(const SaddleProblem& p, const SaddleOptions& options) {
  SaddleReport report;
  const auto fail = [&](SaddleStatus status) {
    report.status = failed_as(status);
    return report;
  };
  begin_search();
  const System& s = system();
  constexpr int longest_hold = 8;
  bool holding = false;
  int stalls = 0, held = 0;  // iterations with the lag held since the last stall
  full_step_ = false;
  factors_alone_ = !kkt_.coupled_possible();
  for (int iteration = 0;; ++iteration) {
    evaluate_here(p);
    if (iteration == 0 && !std::isfinite(now_.energy)) return fail(SaddleStatus::not_finite);
    evaluator_.find_gap(p, now_.x, gap_);
    if (interrupted()) return fail(SaddleStatus::cancelled);
    if (report.iterations >= std::min(options.max_iterations, options.patient_iterations) ||
        report.factorizations >= std::min(options.max_factorizations, options.patient_factorizations))
      return fail(SaddleStatus::iteration_limit);
    if (evaluator_.balanced(p, options, now_, report)) return report;
    if (s.has_bounds()) hold_rows(iteration == 0 ? Rows::first : Rows::later);
    if (!s.laws().empty()) evaluator_.apply_laws(p, now_.lambda, true);
    const bool settled = full_step_ && held_.held == held_before_;
    std::copy(held_.held.begin(), held_.held.end(), held_before_.begin());
    if (holding && held >= stalls && (settled || held >= longest_hold)) holding = false;
    part_->evaluate(slots(), now_.x);
    if (part_->vanishes()) {
      if (!lagged_step(p, report)) return fail(report.status);
    } else if (holding || !coupled_step(p, options, report)) {
      // The step that failed was one.
      if (report.iterations >= options.max_iterations) return fail(SaddleStatus::iteration_limit);
      if (!holding) {
        holding = true;
        held = 0;
        ++stalls;
        evaluate_here(p);
        if (!s.laws().empty()) evaluator_.apply_laws(p, now_.lambda, true);
      }
      ++held;
      ++report.lagged;
      if (!lagged_step(p, report)) return fail(report.status);
    }
    const bool done = evaluator_.balanced(p, options, now_, report);
    if (progress) progress(report.iterations, report.force_residual, report.row_residual);
    // With the lag held, balance counts only once it is renewed.
    if (coupling_ == Coupling::none ? correct(p, options, report) : done || polish(p, options, report))
      return report;
    if (left_all_bounds()) return fail(SaddleStatus::diverged);
  }
}

}  // namespace isochor
