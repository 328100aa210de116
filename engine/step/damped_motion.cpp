// Statics that no load step brings further: a motion with damping so strong that inertia is a mere memory of
// the last position, its weight taken down as it settles, ends in the equilibrium that the body would move to
// (pseudo-transient continuation; Kelley & Keyes 1998, with the switched evolution relaxation of its step).
#include <algorithm>
#include <cmath>

#include "engine/step/stepper.h"

namespace isochor {

namespace {

constexpr int most_steps = 60, patience = 15;
constexpr double negligible = 1e-7;

// Stiffness over mass of the scene [1/s^2]; 0: nothing has mass.
double stiffness_over_mass(const SystemParts& parts, std::span<const double> rest_stiffness) {
  double mass = 0, stiffness = 0;
  for (const double m : parts.mass) mass += m;
  for (const double k : rest_stiffness) stiffness += k;
  return mass > 0 ? stiffness / mass : 0;
}

}  // namespace

// Without inertia from where the motion has settled, and a check of that end.
SaddleReport Stepper::settle(double h, SaddleProblem& problem, SaddleReport total) {
  problem.mass_scale = 0;
  SaddleReport last = solve(problem, saddle_options(context_.options, Allowance{2 * patience, 4 * patience}));
  last.add_work(total);
  if (last.status != SaddleStatus::converged) return last;
  const Surroundings::Found around = surroundings_.renew(trial_.x, Surroundings::Around::solution);
  if (around.changed || around.passing > 0) {
    last.status = SaddleStatus::passed_through;
    // Stencils were renewed around positions that are not to be.
    if (auto back = surroundings_.restore(context_.pool_memory()); !back) last.message = back.error();
  } else if (end_.admits(h, problem, trial_, last)) {
    take(h, false);
  }
  return last;
}

SaddleReport Stepper::damped_motion(double h) {
  const State& state = context_.state;
  const double scale =
      stiffness_over_mass(context_.system().parts(), context_.methods.chosen().rest_stiffness());
  SaddleProblem problem = context_.data.problem(context_.system(), state, state.t + h);
  begin_at_state();
  SaddleReport total;
  total.status = SaddleStatus::line_search_failed;
  if (!(scale > 0)) return total;
  SaddleOptions loose = saddle_options(context_.options, Allowance{patience, 2 * patience});
  loose.force_tolerance = 1e-5;
  loose.row_tolerance = std::max(context_.options.row_tolerance, 1e-7);
  std::vector<Vec3> settled_x = trial_.x;
  std::vector<double> settled_lambda = trial_.lambda;
  double inertia = 0.1, stride = 0;
  for (int k = 0; k < most_steps && inertia < 1e6; ++k) {
    std::copy(settled_x.begin(), settled_x.end(), trial_.predicted.begin());
    problem.predicted = trial_.predicted;
    problem.mass_scale = inertia * scale;
    if (total.factorizations > context_.options.max_iterations) break;
    SaddleReport r = solve(problem, loose);
    const bool ok = r.status == SaddleStatus::converged;
    if (r.status == SaddleStatus::cancelled || r.status == SaddleStatus::out_of_memory) return r;
    r.add_work(total);
    total = std::move(r);
    if (!ok) {
      trial_.begin_at(settled_x, settled_lambda);
      inertia *= 10;
      continue;
    }
    double step = 0;
    for (std::size_t i = 0; i < settled_x.size(); ++i)
      step = std::max(step, norm(trial_.x[i] - settled_x[i]));
    std::copy(trial_.x.begin(), trial_.x.end(), settled_x.begin());
    std::copy(trial_.lambda.begin(), trial_.lambda.end(), settled_lambda.begin());
    // Motions that slow down may take longer strides; one that speeds up goes on carefully.
    inertia *= k == 0 || step > stride ? 0.5 : 0.2;
    stride = step;
    if (inertia > negligible && step > 1e-4 * context_.system().length()) continue;
    total = settle(h, problem, std::move(total));
    const bool settled_well = total.status == SaddleStatus::converged ||
                              total.status == SaddleStatus::passed_through ||
                              total.status == SaddleStatus::inadmissible;
    if (settled_well || total.status == SaddleStatus::cancelled || inertia <= negligible) return total;
    trial_.begin_at(settled_x, settled_lambda);
  }
  if (total.status == SaddleStatus::converged) total.status = SaddleStatus::line_search_failed;
  return total;
}

}  // namespace isochor
