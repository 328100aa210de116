// The line search of Newton's method: backtracking to sufficient decrease of the merit; a shortened step is
// then polished by up to two parabolas, because evaluations cost a few percent of the factorization that a
// better step saves.
#include <algorithm>
#include <cmath>

#include "engine/solve/newton/newton.h"

namespace isochor {

// The merit along a direction.
struct Newton::LineSearch {
  double start = 0, slope = 0;
  double noise = 0;         // of the merit
  double longest = 0;       // displacement of a whole step [m]
  double most = 1;          // part of it that may be taken
  double tau = 1;           // that was tried last
  double value = 0;         // there
  double force_before = 0;  // residual of forces at the start

  double enough() const { return start + 1e-4 * tau * slope; }
  // Where the parabola through the start, its slope and the last value has its minimum.
  double parabola_minimum() const {
    const double curvature = value - start - slope * tau;
    return curvature > 0 ? -0.5 * slope * tau * tau / curvature : 3 * tau;
  }
};

// Moves the trial point to tau along the direction.
void Newton::set_trial(double tau) {
  for (std::size_t i = 0; i < now_.x.size(); ++i) trial_.x[i] = now_.x[i] + tau * step_.dx[i];
  for (std::size_t r = 0; r < now_.lambda.size(); ++r)
    trial_.lambda[r] = now_.lambda[r] + tau * (step_.lambda[r] - now_.lambda[r]);
  if (!trial_.asked.empty()) trial_.asked = trial_.lambda;
}

// The merit there.
double Newton::try_step(const SaddleProblem& p, double tau, SaddleReport& report) {
  const Stopwatch watch(seconds_.line_search);
  ++report.trials;
  set_trial(tau);
  evaluator_.evaluate(p, Want::gradient, Definiteness::exact, trial_);
  return merit_.value(p, tau, trial_, step_, held_, gap_);
}

// The same with multipliers within their bounds and a new lag, without a merit.
void Newton::try_coupled(const SaddleProblem& p, double tau, SaddleReport& report) {
  const Stopwatch watch(seconds_.line_search);
  ++report.trials;
  set_trial(tau);
  evaluator_.clamp(trial_.lambda);
  evaluator_.renew_lag(p, trial_);
  evaluator_.evaluate(p, Want::gradient, Definiteness::exact, trial_);
}

// Goes to the trial point, multipliers projected on their bounds. Those that the projection moved change the
// forces, which are evaluated again.
void Newton::take_trial(const SaddleProblem& p) {
  std::swap(now_, trial_);
  if (!system().has_bounds()) return;
  evaluator_.clamp(now_.lambda);
  if (now_.lambda == now_.asked) return;
  evaluator_.evaluate(p, Want::gradient, Definiteness::exact, now_);
}

bool Newton::may_go_uphill() const {
  return watchdog_.may_begin() && !matrix_.mended() && !gap_.open && !held_.any && !system().has_lag();
}

// The step behind one that was taken uphill. True when now_ has moved on; otherwise all is as before that
// step, with its direction, ready for a search that backtracks.
bool Newton::watch(const SaddleProblem& p, SaddleReport& report) {
  try_step(p, 1, report);
  std::copy(uphill_.step.lambda.begin(), uphill_.step.lambda.end(), step_.lambda.begin());
  merit_.set_gamma(uphill_.gamma);
  const Watchdog::Outcome outcome = watchdog_.judge(merit_.value(p, 1, trial_, step_, held_, gap_));
  if (outcome != Watchdog::Outcome::failed) {
    take_trial(p);
    full_step_ = outcome == Watchdog::Outcome::reached;
    return true;
  }
  now_.set(uphill_.x, uphill_.lambda);
  std::copy(uphill_.step.dx.begin(), uphill_.step.dx.end(), step_.dx.begin());
  evaluator_.evaluate(p, Want::gradient, Definiteness::exact, now_);
  return false;
}

// The part of a step up to tau after which no row that its bound has let go is violated too much.
double Newton::longest_step(double tau) {
  const auto most = system().row_overshoot();
  if (most.empty() || !held_.any) return tau;
  slots().jacobian_times(step_.dx, work_.row);
  for (std::size_t r = 0; r < most.size(); ++r) {
    if (!held_.held[r] || !std::isfinite(most[r])) continue;
    // Away from zero, on the side that the bound does not hold.
    const double sign = held_.bound[r] == system().row_upper()[r] ? -1 : 1;
    const double way = sign * work_.row[r], left = most[r] - sign * now_.theta[r];
    if (way * tau > left && left > 0) tau = left / way;
  }
  return tau;
}

// A whole step that the merit refuses, or the part of it that the watchdog lets go, is taken all the same.
// False: it has no value.
bool Newton::try_uphill(const SaddleProblem& p, LineSearch& line, SaddleReport& report) {
  if (watchdog_.length() < 1) {
    line.tau = watchdog_.length();
    line.value = try_step(p, line.tau, report);
    if (!std::isfinite(line.value)) return false;
  }
  if (line.value <= line.enough()) return true;
  watchdog_.begin(line.enough(), line.value - line.enough());
  uphill_.gamma = merit_.gamma();
  std::copy(now_.x.begin(), now_.x.end(), uphill_.x.begin());
  std::copy(now_.lambda.begin(), now_.lambda.end(), uphill_.lambda.begin());
  std::copy(step_.dx.begin(), step_.dx.end(), uphill_.step.dx.begin());
  std::copy(step_.lambda.begin(), step_.lambda.end(), uphill_.step.lambda.begin());
  return true;
}

bool Newton::backtrack(const SaddleProblem& p, LineSearch& line, SaddleReport& report) {
  constexpr int most_trials = 40;
  constexpr double shortest = 1e-10;
  constexpr double creep = 0.2;  // a shorter step is one
  for (int trial = 0; trial < most_trials && line.tau > shortest; ++trial) {
    if (interrupted()) return false;
    line.value = try_step(p, line.tau, report);
    if (!std::isfinite(line.value)) {
      line.tau *= 0.5;
      continue;
    }
    if (line.value <= line.enough()) return true;
    // Where the decrease drowns in rounding, the residual decides.
    if (std::abs(line.tau * line.slope) < 10 * line.noise && line.value <= line.start + 10 * line.noise) {
      const double after = evaluator_.measure(p, trial_).force;
      if (after <= line.force_before || after < 1e-7) return true;
    }
    // Only where backtracking would creep.
    if (line.tau == 1 && line.parabola_minimum() < creep && may_go_uphill()) {
      if (try_uphill(p, line, report)) return true;
      continue;
    }
    line.tau = std::clamp(line.parabola_minimum(), 0.1 * line.tau, 0.5 * line.tau);
  }
  return false;
}

void Newton::polish(const SaddleProblem& p, LineSearch& line, SaddleReport& report) {
  for (int k = 0; k < 2 && line.tau < line.most; ++k) {
    const double next =
        std::min(line.most, std::clamp(line.parabola_minimum(), 0.3 * line.tau, 3 * line.tau));
    if (std::abs(next - line.tau) < 0.15 * line.tau) break;
    const double other = try_step(p, next, report);
    if (!(other < line.value)) {
      try_step(p, line.tau, report);
      break;
    }
    line.value = other;
    line.tau = next;
  }
}

// True when now_ has moved.
bool Newton::search(const SaddleProblem& p, SaddleReport& report) {
  constexpr double farthest = 100;  // of the scene's length
  const System& s = system();
  LineSearch line;
  line.slope = merit_.slope(now_, step_, held_, gap_);
  line.start = merit_.value(p, 0, now_, step_, held_, gap_);
  line.noise = 1e-12 * (evaluator_.potential_magnitude(p, now_) + std::abs(line.start));
  line.force_before = evaluator_.measure(p, now_).force;
  for (const Vec3& d : step_.dx) line.longest = std::max(line.longest, norm(d));
  const double reach = farthest * s.length();
  line.most = line.tau = pace_.damping * longest_step(line.longest > reach ? reach / line.longest : 1);
  if (!backtrack(p, line, report)) return false;
  polish(p, line, report);
  take_trial(p);
  report.step = line.tau * line.longest;
  full_step_ = line.tau == 1;
  pace_.resting = pace_.resting || (gap_.open && line.tau < 1);
  // Stencils that change with what is close may have a small jump where what is nearest changes: a search
  // that goes downhill creeps up to it and stays, until they are renewed.
  pace_.creeping = line.tau < (s.renews_stencils() ? 0.01 * line.most : 1e-3) ? pace_.creeping + 1 : 0;
  return true;
}

// Once more along a direction that is as exact as it can be.
bool Newton::search_exactly(const SaddleProblem& p, SaddleReport& report) {
  if (interrupted()) return false;
  evaluator_.evaluate(p, Want::gradient, Definiteness::exact, now_);
  inexact_ = 0;
  const bool found = direction(report) && search(p, report);
  inexact_ = inexact_direction;
  return found;
}

}  // namespace isochor
