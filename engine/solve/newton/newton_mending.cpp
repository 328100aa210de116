// Directions that are not what Newton's method promises: what is done when the inertia is wrong, the
// direction leads uphill, or whole steps go in a circle.
#include <algorithm>
#include <cmath>

#include "engine/solve/newton/newton.h"

namespace isochor {

// Whether the merit falls along the direction, with a penalty in proportion. The right inertia implies it
// (Chiang & Zavala 2016 replace the inertia by such a test).
bool Newton::descends(const SaddleProblem& p, std::span<const Vec3> x, std::span<const double> lambda) {
  constexpr double largest_penalty = 1e3;
  const double kept = gamma_;
  const double slope = merit_slope(lambda);
  const bool moderate = gamma_ <= std::max(kept, largest_penalty);
  gamma_ = kept;
  return moderate && slope <= 1e-12 * potential_magnitude(p, x);
}

// Surfaces that press on each other hard, from equal bodies, are in equilibrium as they lie and yet would
// slip off each other at their borders. Which branch a host wants is told by where the last step was: a
// direction that goes downhill as it is, whatever the inertia, stays on it.
bool Newton::descend_unmended(const SaddleProblem& p, std::span<const Vec3> x, std::span<const double> lambda,
                              SaddleReport& report) {
  mended_ = false;
  if (factor_shifted(p.mass_scale, 0, report)) return direction(lambda, report);
  return report.status == SaddleStatus::converged && !singular_ && report.negative_pivots >= 0 &&
         direction(lambda, report) && descends(p, x, lambda);
}

// The ladder of factor(), for directions that do not descend or were not found.
bool Newton::mend_direction(const SaddleProblem& p, std::span<const Vec3> x, std::span<const double> lambda,
                            SaddleReport& report) {
  ++report.shifted;
  const auto works = [&](double shift) {
    return factor_shifted(p.mass_scale, shift, report) && direction(lambda, report) && descends(p, x, lambda);
  };
  for (double shift = shift_ > 0 ? std::max(smallest_shift, shift_ / 3) : 1e-3; shift < 1; shift *= 6) {
    if (works(shift)) {
      shift_ = shift;
      return true;
    }
    if (gave_up(report)) return false;
  }
  {
    const Stopwatch watch(seconds_.evaluate);
    assembly_.evaluate(Want::hessian, std::max(definiteness_, Definiteness::projected), x, lambda,
                       p.prescribed);
  }
  ++report.projected;
  for (double shift = 0; shift < 1e3; shift = std::max(1e-3, 30 * shift)) {
    if (works(shift)) return true;
    if (gave_up(report)) return false;
  }
  if (report.message.empty()) report.message = "the linear solver found no direction of descent";
  return false;
}

// What touches at corners of faces may jump from one to the next and back in whole steps, each of which goes
// downhill in the merit of its own multipliers. A residual that comes back tells; shorter steps end in
// between.
void Newton::damp_cycles(const SaddleReport& report) {
  constexpr double same = 1e-3, shortest = 0.125, left = 0.1;
  const double now = report.force_residual;
  if (now < left * cycle_) {
    damping_ = 1;
    cycle_ = 0;
  }
  // The last one may be as large where steps are short.
  const bool returns = std::any_of(past_residuals_.begin() + 1, past_residuals_.end(), [now](double before) {
    return before > 0 && std::abs(now - before) < same * now;
  });
  if (returns && full_step_) {
    damping_ = std::max(shortest, 0.5 * damping_);
    cycle_ = cycle_ > 0 ? std::min(cycle_, now) : now;
  } else if (returns && damping_ < 1 && damping_ > shortest) {
    damping_ *= 0.5;
  }
  std::rotate(past_residuals_.begin(), past_residuals_.end() - 1, past_residuals_.end());
  past_residuals_[0] = now;
}

}  // namespace isochor
