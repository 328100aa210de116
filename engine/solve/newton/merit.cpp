#include "engine/solve/newton/merit.h"

#include <algorithm>
#include <cmath>

namespace isochor {

Merit::Merit(Evaluator& evaluator)
    : evaluator_(evaluator),
      reaction_(at(evaluator.system().nodes())),
      node_work_(reaction_.size()),
      inertia_(reaction_.size()),
      row_work_(at(evaluator.system().rows())) {}

// r + H dx + G^T dlambda + reaction = 0 at the given directions. Leaves the reactions, takes their work on
// the gap off q, and returns the square of the gap in units of stiffness.
double Merit::add_slope_of_gap(const Iterate& now, const Direction& step, const Gap& gap, double& q) {
  Assembly& assembly = evaluator_.assembly();
  const double mass_scale = evaluator_.mass_scale();
  const auto stiffness = evaluator_.stiffness();
  assembly.hessian_times(step.dx, node_work_);
  if (mass_scale > 0) {
    assembly.mass_times(step.dx, inertia_);
    for (std::size_t i = 0; i < node_work_.size(); ++i) node_work_[i] += mass_scale * inertia_[i];
  }
  for (std::size_t r = 0; r < row_work_.size(); ++r) row_work_[r] = step.lambda[r] - now.lambda[r];
  assembly.constraint_force(row_work_, reaction_);
  double size = 0;
  for (std::size_t i = 0; i < reaction_.size(); ++i) {
    reaction_[i] = -(now.force[i] + node_work_[i] + reaction_[i]);
    q -= dot(reaction_[i], gap.way[i]);
    size += stiffness[i] * dot(gap.way[i], gap.way[i]);
  }
  return size;
}

double Merit::slope(const Iterate& now, const Direction& step, const HeldRows& held, const Gap& gap) {
  const System& s = evaluator_.system();
  double q = 0, theta_size = 0, gap_size = 0;
  for (std::size_t i = 0; i < step.dx.size(); ++i) q -= dot(step.dx[i], now.force[i]);
  for (std::size_t r = 0; r < now.theta.size(); ++r) {
    if (held.holds(r)) continue;
    q += now.theta[r] * (step.lambda[r] - now.lambda[r]);
    theta_size += now.theta[r] * now.theta[r] / s.row_metric()[r];
  }
  if (held.any) {
    // Rows held at a bound do not head for theta = 0: the change of theta along the step is taken as it is.
    evaluator_.assembly().jacobian_times(step.dx, row_work_);
    for (std::size_t r = 0; r < now.theta.size(); ++r) {
      if (held.held[r]) q -= row_work_[r] * held.way[r];
    }
  }
  if (gap.open) {
    gap_size = add_slope_of_gap(now, step, gap, q);
  }
  const double penalty = theta_size + gap_size;
  while (q + gamma_ * penalty < 0.1 * gamma_ * penalty && gamma_ < 1e12) gamma_ *= 4;
  return -q - gamma_ * penalty;
}

double Merit::value(const SaddleProblem& p, double tau, const Iterate& it, const Direction& step,
                    const HeldRows& held, const Gap& gap) const {
  const System& s = evaluator_.system();
  double sum = evaluator_.potential(p, it) + compliance_energy(s, it.lambda);
  if (!s.laws().empty()) sum += it.law_energy;
  for (std::size_t r = 0; r < it.theta.size(); ++r) {
    const double theta = it.theta[r];
    if (held.holds(r)) {
      // max over multipliers within the bounds of multiplier * theta - its distance from the new estimate.
      const double stiffness = gamma_ / s.row_metric()[r];
      const double l = step.lambda[r];
      const double best = std::clamp(l + stiffness * theta, s.row_lower()[r], s.row_upper()[r]);
      sum += best * theta - 0.5 * (best - l) * (best - l) / stiffness;
      continue;
    }
    sum += step.lambda[r] * theta + 0.5 * gamma_ * theta * theta / s.row_metric()[r];
  }
  if (gap.open) {
    const auto stiffness = evaluator_.stiffness();
    for (std::size_t i = 0; i < reaction_.size(); ++i) {
      const Vec3 left = (tau - 1) * gap.way[i];
      sum += dot(reaction_[i], left) + 0.5 * gamma_ * stiffness[i] * dot(left, left);
    }
  }
  return sum;
}

}  // namespace isochor
