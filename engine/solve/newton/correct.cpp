// Corrections: close to the solution the factors at hand are as good as new ones for a step or two, at a few
// percent of the price.
#include <algorithm>
#include <cmath>

#include "engine/solve/newton/newton.h"

namespace isochor {

namespace {

// Whether a correction was worth it, from the residuals before and after: with less of a reduction, a new
// factorization is the better buy.
bool pays(double force, double row, const SaddleReport& after, const SaddleOptions& options) {
  constexpr double worthwhile = 0.3;
  return after.force_residual <= std::max(worthwhile * force, options.force_tolerance) &&
         after.row_residual <= std::max(worthwhile * row, options.row_tolerance);
}

}  // namespace

// Corrections are tried from here on.
bool Newton::close_enough(const SaddleReport& report) {
  return report.force_residual <= 1e-2 && report.row_residual <= 1e-2;
}

// Further steps of a system with a lag that know how forces change with it, with the factors at hand,
// symmetric or not. True when the state is in balance. The last evaluation was at now_, with a lag of there.
bool Newton::correct_coupled(const SaddleProblem& p, const SaddleOptions& options, SaddleReport& report) {
  constexpr int most = 6;
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
    const double force = report.force_residual, row = report.row_residual;
    try_coupled(p, 1, report);
    if (!std::isfinite(trial_.energy)) return false;
    ++report.corrections;
    const bool done = evaluator_.balanced(p, options, trial_, report);
    if (!pays(force, row, report, options)) return false;
    std::swap(now_, trial_);
    if (done) return true;
  }
  return false;
}

// Steps that hold the lag within each. A correction that does not pay is dropped.
bool Newton::correct_lagged(const SaddleProblem& p, const SaddleOptions& options, SaddleReport& report) {
  const bool lags = system().has_lag();
  const int most = lags ? 12 : 6;
  for (int k = 0; k < most; ++k) {
    if (lags) {
      evaluator_.renew_lag(p, now_);
      evaluator_.evaluate(p, Want::gradient, Definiteness::exact, now_);
      if (evaluator_.balanced(p, options, now_, report)) return true;
    }
    evaluator_.find_gap(p, now_.x, gap_);
    if (gap_.open || !direction(report)) return false;
    const double force = report.force_residual, row = report.row_residual;
    if (!std::isfinite(try_step(p, 1, report))) return false;
    ++report.corrections;
    const bool done = evaluator_.balanced(p, options, trial_, report);
    if (!pays(force, row, report, options)) return false;
    take_trial(p);
    if (done && !lags) return true;
  }
  return false;
}

// True when the state is in balance.
bool Newton::correct(const SaddleProblem& p, const SaddleOptions& options, SaddleReport& report) {
  if (!options.corrections || !full_step_ || !close_enough(report)) return false;
  if ((part_ || moves_bounds_) && kkt_.coupled_possible()) {
    if (part_) {
      evaluator_.renew_lag(p, now_);
      evaluator_.evaluate_lagging(p, now_);
      if (evaluator_.balanced(p, options, now_, report)) return true;
    }
    coupling_ = Coupling::added;
    coupled_tolerance_ = correction_tolerance;
    const bool done = correct_coupled(p, options, report);
    coupling_ = Coupling::none;
    // Steep friction may ask for steps that hold the lag instead.
    if (done || !part_ || !kkt_.holds(held_.held)) return done;
  }
  return correct_lagged(p, options, report);
}

}  // namespace isochor
