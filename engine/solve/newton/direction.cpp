// Directions of Newton's method: which rows are held at a bound, and the linear system's right-hand side.
#include <algorithm>
#include <cmath>

#include "engine/solve/newton/newton.h"

namespace isochor {

// The active set of the primal-dual active-set method: a row whose multiplier would leave its bounds under
// the force law lambda + theta / metric is held at the bound in this linear system (Hintermueller, Ito &
// Kunisch 2002). The multiplier is that which the last step asked for: of the one put back to its bound only
// rounding would tell whether the row is to be let go. What just touches at the start of a solve (no
// multiplier, no distance) is taken as met: a body that rests there would fall freely in the first iteration.
// Where it pulls away, the next one lets go.
void Newton::hold_rows(Rows when) {
  const System& s = system();
  const auto lower = s.row_lower(), upper = s.row_upper();
  const bool first = when == Rows::first;
  held_.any = false;
  for (std::size_t r = 0; r < held_.held.size(); ++r) {
    const double trial = now_.asked[r] + now_.theta[r] / s.row_metric()[r];
    constexpr double touching = 1e-10;  // of the row's measure
    const double slack = first ? touching * s.row_measure()[r] / s.row_metric()[r] : 0;
    const bool held =
        first ? trial < lower[r] - slack || trial > upper[r] + slack : trial <= lower[r] || trial >= upper[r];
    held_.held[r] = held ? 1 : 0;
    if (held) held_.bound[r] = trial <= lower[r] ? lower[r] : upper[r];
    held_.any = held_.any || held;
  }
  matrix_.hold(held_.rows());
}

// Prescribed coordinates move by their whole gap.
void Newton::add_gap() {
  if (gap_.open) {
    slots().hessian_times(gap_.way, work_.node);
    evaluator_.add_inertia_of_gap(gap_, work_.node);
    slots().jacobian_times(gap_.way, work_.row);
  } else {
    std::fill(work_.node.begin(), work_.node.end(), Vec3{});
    std::fill(work_.row.begin(), work_.row.end(), 0.0);
  }
  for (std::size_t r = 0; r < now_.theta.size(); ++r) work_.row_rhs[r] = -(now_.theta[r] + work_.row[r]);
}

// Multipliers held at a bound move by the rest of their way there.
void Newton::add_held() {
  if (!held_.any) return;
  const System& s = system();
  for (std::size_t r = 0; r < held_.held.size(); ++r)
    held_.way[r] = held_.held[r] ? held_.bound[r] - now_.lambda[r] : 0;
  slots().constraint_force(held_.way, work_.force);
  for (std::size_t i = 0; i < work_.force.size(); ++i) work_.node[i] += work_.force[i];
  std::fill(work_.row.begin(), work_.row.end(), 0.0);
  add_compliance(s, 1, held_.way, work_.row);
  for (std::size_t r = 0; r < held_.held.size(); ++r) {
    if (held_.held[r])
      work_.row_rhs[r] = -s.row_metric()[r] * held_.way[r];
    else
      work_.row_rhs[r] += work_.row[r];
  }
}

// Solves for the step, from the last evaluation, which was at now_.
bool Newton::direction(SaddleReport& report) {
  add_gap();
  add_held();
  if (coupling_ != Coupling::none && part_ && (gap_.open || held_.any)) {
    if (!held_.any) std::fill(held_.way.begin(), held_.way.end(), 0.0);
    part_->add_times(gap_.way, held_.way, work_.node);
  }
  for (std::size_t i = 0; i < now_.force.size(); ++i) work_.node_rhs[i] = -(now_.force[i] + work_.node[i]);
  const std::int64_t before = kkt_.dual_iterations(), linear_before = kkt_.linear_iterations();
  const bool ok =
      coupling_ == Coupling::added
          ? kkt_.solve_coupled(part_ ? &*part_ : nullptr, held_.rows(), work_.node_rhs, work_.row_rhs,
                               coupled_tolerance_, step_.dx, step_.lambda, seconds_)
          : kkt_.solve(work_.node_rhs, work_.row_rhs, step_.dx, step_.lambda, seconds_, inexact_);
  report.dual.iterations += kkt_.dual_iterations() - before;
  report.krylov.iterations += kkt_.linear_iterations() - linear_before;
  report.linear_residual = kkt_.residual();
  for (std::size_t i = 0; i < step_.dx.size(); ++i) step_.dx[i] += gap_.way[i];
  for (std::size_t r = 0; r < step_.lambda.size(); ++r) step_.lambda[r] += now_.lambda[r];
  // What is solved in steps is not exact, but a bound is.
  for (std::size_t r = 0; coupling_ == Coupling::added && held_.any && r < held_.held.size(); ++r) {
    if (held_.held[r]) step_.lambda[r] = held_.bound[r];
  }
  return ok && std::all_of(step_.dx.begin(), step_.dx.end(), finite);
}

// Whether the merit falls along the direction, with a penalty in proportion. The right inertia implies it
// (Chiang & Zavala 2016 replace the inertia by such a test).
bool Newton::descends(const SaddleProblem& p) {
  constexpr double largest_penalty = 1e3;
  const double kept = merit_.gamma();
  const double slope = merit_.slope(now_, step_, held_, gap_);
  const bool moderate = merit_.gamma() <= std::max(kept, largest_penalty);
  merit_.set_gamma(kept);
  return moderate && slope <= 1e-12 * evaluator_.potential_magnitude(p, now_);
}

// Surfaces that press on each other hard, from equal bodies, are in equilibrium as they lie and yet would
// slip off each other at their borders. Which branch a host wants is told by where the last step was: a
// direction that goes downhill as it is, whatever the inertia, stays on it.
bool Newton::descend_unmended(const SaddleProblem& p, SaddleReport& report) {
  if (matrix_.factor_exact(report)) return direction(report);
  return report.status == SaddleStatus::converged && !matrix_.singular() && report.negative_pivots >= 0 &&
         direction(report) && descends(p);
}

// For directions that do not descend or were not found.
bool Newton::mend_direction(const SaddleProblem& p, SaddleReport& report) {
  return matrix_.factor_until(p, now_.x, now_.lambda, report,
                              [&] { return direction(report) && descends(p); });
}

// False: the report's status says why, or (converged) the matrix is singular.
bool Newton::find_direction(const SaddleProblem& p, bool unmended, SaddleReport& report) {
  bool found = unmended && descend_unmended(p, report);
  if (!found) {
    if (report.status == SaddleStatus::out_of_memory) return false;
    if (!matrix_.factor(p, now_.x, now_.lambda, report)) return false;
    found = direction(report);
  }
  if (!found && kkt_.inertia_was_wrong())
    found = matrix_.factor(p, now_.x, now_.lambda, report) && direction(report);
  // A backend that cannot tell the inertia is judged by its directions.
  if (report.negative_pivots < 0 && !(found && descends(p))) found = mend_direction(p, report);
  return found;
}

}  // namespace isochor
