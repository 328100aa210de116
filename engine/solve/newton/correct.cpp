// Corrections: close to the solution the factors at hand are as good as new ones for a step or two, at a few
// percent of the price.
#include <algorithm>
#include <cmath>

#include "engine/solve/newton/newton.h"

namespace isochor {

namespace {

// What is left of the residuals, or may be.
struct Left {
  double force, row;

  explicit Left(const SaddleReport& report) : force(report.force_residual), row(report.row_residual) {}
  Left(double part, const SaddleOptions& o) : force(part * o.force_tolerance), row(part * o.row_tolerance) {}
  bool within(const Left& goal) const { return force <= goal.force && row <= goal.row; }
  // Whether a correction was worth it: with less of a reduction on the way to a goal, a new factorization is
  // the better buy.
  bool pays(double worthwhile, const Left& before, const Left& goal) const {
    return force <= std::max(worthwhile * before.force, goal.force) &&
           row <= std::max(worthwhile * before.row, goal.row);
  }
};

}  // namespace

// Corrections are tried from here on.
bool Newton::close_enough(const SaddleReport& report) {
  return report.force_residual <= 1e-2 && report.row_residual <= 1e-2;
}

// Further steps of a system with a lag that know how forces change with it, with the factors at hand,
// symmetric or not. True when the state is in balance. The last evaluation was at now_, with a lag of there.
bool Newton::correct_coupled(const SaddleProblem& p, const SaddleOptions& options, SaddleReport& report) {
  constexpr int most = 6;
  constexpr double worthwhile = 0.3;
  const Left balance(1, options);
  const bool adds = coupling_ == Coupling::added;
  bool moved = false;
  for (int k = 0; k < most; ++k) {
    evaluator_.find_gap(p, now_.x, gap_);
    if (gap_.open) return false;
    if (adds && part_) part_->evaluate(slots(), now_.x);
    if (adds && moves_bounds_) {
      hold_rows(Rows::later);
      // Where it is the very matrix that was factored, its own solve is as exact as a solve can be.
      moved = moved || part_ || !kkt_.holds(held_.held);
      coupling_ = moved ? Coupling::added : Coupling::none;
    }
    if (!direction(report)) return false;
    const Left before(report);
    try_coupled(p, 1, report);
    if (!std::isfinite(trial_.energy)) return false;
    ++report.corrections;
    const bool done = evaluator_.balanced(p, options, trial_, report);
    if (!Left(report).pays(worthwhile, before, balance)) return false;
    std::swap(now_, trial_);
    if (done) return true;
  }
  return false;
}

// Steps that hold the lag within each. A correction that does not pay is dropped.
bool Newton::correct_lagged(const SaddleProblem& p, const SaddleOptions& options, SaddleReport& report) {
  constexpr int most = 12;
  constexpr double worthwhile = 0.3;
  const Left balance(1, options);
  for (int k = 0; k < most; ++k) {
    evaluator_.renew_lag(p, now_);
    evaluator_.evaluate(p, Want::gradient, Definiteness::exact, now_);
    if (evaluator_.balanced(p, options, now_, report)) return true;
    evaluator_.find_gap(p, now_.x, gap_);
    if (gap_.open || !direction(report)) return false;
    const Left before(report);
    if (!std::isfinite(try_step(p, 1, report))) return false;
    ++report.corrections;
    evaluator_.balanced(p, options, trial_, report);
    if (!Left(report).pays(worthwhile, before, balance)) return false;
    take_trial(p);
  }
  return false;
}

// Steps without a lag, as long as each halves what is left. They converge linearly, and an end just within
// the tolerance would be as far off as the softest way to move makes of it: those that arrive go on for two
// digits more, or until they gain nothing.
bool Newton::correct_plain(const SaddleProblem& p, const SaddleOptions& options, SaddleReport& report) {
  constexpr int most = 14;
  constexpr double worthwhile = 0.5, deeper = 1e-2;
  const Left balance(1, options), deep(deeper, options);
  bool done = evaluator_.balanced(p, options, now_, report);
  for (int k = 0; k < most && !(done && Left(report).within(deep)) && !interrupted(); ++k) {
    evaluator_.find_gap(p, now_.x, gap_);
    if (gap_.open || !direction(report)) break;
    const Left before(report);
    if (!std::isfinite(try_step(p, 1, report))) break;
    ++report.corrections;
    const bool arrived = evaluator_.balanced(p, options, trial_, report);
    if ((done && !arrived) || !Left(report).pays(worthwhile, before, done ? deep : balance)) {
      report.force_residual = before.force;
      report.row_residual = before.row;
      break;
    }
    take_trial(p);
    done = arrived;
  }
  return done;
}

// True when the state is in balance.
bool Newton::correct(const SaddleProblem& p, const SaddleOptions& options, SaddleReport& report) {
  if (!options.corrections || !full_step_ || !close_enough(report)) return false;
  if ((part_ || moves_bounds_) && kkt_.coupled_possible()) {
    if (part_) {
      evaluator_.renew_lag(p, now_);
      evaluator_.evaluate_lagging(p, now_);
    }
    if (evaluator_.balanced(p, options, now_, report)) return true;
    coupling_ = Coupling::added;
    coupled_tolerance_ = correction_tolerance;
    const bool done = correct_coupled(p, options, report);
    coupling_ = Coupling::none;
    // Steep friction may ask for steps that hold the lag instead.
    if (done || !part_ || !kkt_.holds(held_.held)) return done;
  }
  if (system().has_lag()) return correct_lagged(p, options, report);
  inexact_ = inexact_correction;
  const bool done = correct_plain(p, options, report);
  inexact_ = inexact_direction;
  return done;
}

}  // namespace isochor
