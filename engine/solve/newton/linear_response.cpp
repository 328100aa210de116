// Derivatives at a solution, by differences of Newton steps on one factorization: what is solved is linear in
// the right-hand side, so that a difference of steps for two problems is the step for their difference.
#include "engine/solve/newton/newton.h"

namespace isochor {

// Evaluates at now_ and factors the matrix as it is.
bool Newton::factor_as_is(const SaddleProblem& p, SaddleReport& report) {
  if (!all_finite(p)) {
    report.status = SaddleStatus::not_finite;
    return false;
  }
  slots().set_increment(p.increment, p.memory);
  coupling_ = Coupling::none;
  inexact_ = 0;
  evaluate_here(p);
  evaluator_.find_gap(p, now_.x, gap_);
  if (system().has_bounds()) hold_rows(Rows::later);
  if (!system().laws().empty()) evaluator_.apply_laws(p, now_.lambda, true);
  matrix_.factor_exact(report);  // the inertia is reported, not mended
  if (report.message.empty() && !matrix_.singular()) return true;
  report.status = SaddleStatus::singular;
  return false;
}

// The Newton step of another problem, with the factors at hand, into step_.
bool Newton::step_as_is(const SaddleProblem& p, SaddleReport& report) {
  evaluator_.evaluate(p, Want::gradient, Definiteness::exact, now_);
  evaluator_.find_gap(p, now_.x, gap_);
  if (direction(report)) return true;
  report.status = SaddleStatus::singular;
  return false;
}

bool Newton::linearize(const SaddleProblem& p, std::span<const Vec3> x, std::span<const double> lambda,
                       SaddleReport& report) {
  kkt_.linear_solver().begin_solve();
  evaluator_.begin(p);
  matrix_.begin(Definiteness::exact);
  held_.any = false;
  now_.set(x, lambda);
  if (!factor_as_is(p, report)) return false;
  // What is held on to within an iteration goes along with a solution.
  if (!part_ || !kkt_.coupled_possible()) return true;
  part_->evaluate(slots(), now_.x);
  if (part_->vanishes()) return true;
  coupling_ = Coupling::added;
  coupled_tolerance_ = 1e-10;
  return true;
}

bool Newton::respond(const SaddleProblem& p, std::span<Vec3> dx, std::span<double> lambda,
                     SaddleReport& report) {
  evaluator_.renew_lag(p, now_);
  if (!step_as_is(p, report)) return false;
  std::copy(step_.dx.begin(), step_.dx.end(), dx.begin());
  std::copy(step_.lambda.begin(), step_.lambda.end(), lambda.begin());
  return true;
}

}  // namespace isochor
