#include "engine/solve/newton/newton.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace isochor {

namespace {

constexpr int most_failed_ventures = 3;
constexpr int most_returns = 4;
// A shorter step is a creep.
constexpr double creep = 0.2;
// Less of a reduction by a correction, and a new factorization is the better buy.
constexpr double worthwhile = 0.3;

// Whether a correction was worth it, from the residuals before and after.
bool pays(double force, double row, const SaddleReport& after, const SaddleOptions& options) {
  return after.force_residual <= std::max(worthwhile * force, options.force_tolerance) &&
         after.row_residual <= std::max(worthwhile * row, options.row_tolerance);
}

// Where the parabola through the start, its slope and one value has its minimum.
double parabola_minimum(double tau, double start, double slope, double value) {
  const double curvature = value - start - slope * tau;
  return curvature > 0 ? -0.5 * slope * tau * tau / curvature : 3 * tau;
}

}  // namespace

Newton::Newton(std::shared_ptr<const System> system, const Parallel& parallel,
               std::unique_ptr<LinearSolver> solver)
    : SaddlePoint(std::move(system), parallel, std::move(solver)) {
  const System& s = *system_;
  const std::size_t n = at(s.nodes()), m = at(s.rows());
  row_rhs_.resize(m);
  node_rhs_.resize(n);
  row_work_.resize(m);
  lambda_new_.resize(m);
  lambda_trial_.resize(m);
  dx_.resize(n);
  node_work_.resize(n);
  x_trial_.resize(n);
  reaction_.resize(n);
  venture_.x.resize(n);
  venture_.dx.resize(n);
  venture_.lambda.resize(m);
  venture_.lambda_new.resize(m);
  to_bound_.assign(s.has_bounds() || s.has_lag() ? m : 0, 0);
  if (s.has_bounds()) bound_.assign(m, 0);
  if (s.has_lag()) part_.emplace(system_, parallel);
  moves_bounds_ = kkt_.coupled_possible() && s.has_bounds();
  if (kkt_.coupled_possible() && (part_ || moves_bounds_)) kkt_.prepare_coupled();
}

// The active set of the primal-dual active-set method: a row whose multiplier would leave its bounds under
// the force law lambda + theta / metric is held at the bound in this linear system (Hintermueller, Ito &
// Kunisch 2002). What just touches at the start of a solve (no multiplier, no distance) is taken as met: a
// body that rests there would fall freely in the first iteration. Where it pulls away, the next one lets go.
void Newton::choose_clamped(std::span<const double> lambda, bool first) {
  const System& s = *system_;
  const auto lower = s.row_lower(), upper = s.row_upper();
  any_clamped_ = false;
  for (std::size_t r = 0; r < clamped_.size(); ++r) {
    const double trial = lambda[r] + theta_[r] / s.row_metric()[r];
    constexpr double touching = 1e-10;  // of the row's measure
    const double slack = first ? touching * s.row_measure()[r] / s.row_metric()[r] : 0;
    clamped_[r] =
        first ? trial < lower[r] - slack || trial > upper[r] + slack : trial <= lower[r] || trial >= upper[r];
    if (clamped_[r]) bound_[r] = trial <= lower[r] ? lower[r] : upper[r];
    any_clamped_ = any_clamped_ || clamped_[r];
  }
}

// Solves for (dx, dlambda); prescribed coordinates move by their whole gap, multipliers held at a bound by
// the rest of their way there.
bool Newton::direction(std::span<const double> lambda, SaddleReport& report) {
  const System& s = *system_;
  if (has_gap_) {
    assembly_.hessian_times(gap_, node_work_);
    add_inertia_of_gap(node_work_);
    assembly_.jacobian_times(gap_, row_work_);
  } else {
    std::fill(node_work_.begin(), node_work_.end(), Vec3{});
    std::fill(row_work_.begin(), row_work_.end(), 0.0);
  }
  for (std::size_t r = 0; r < theta_.size(); ++r) row_rhs_[r] = -(theta_[r] + row_work_[r]);
  if (any_clamped_) {
    for (std::size_t r = 0; r < clamped_.size(); ++r) to_bound_[r] = clamped_[r] ? bound_[r] - lambda[r] : 0;
    assembly_.constraint_force(to_bound_, reaction_);
    for (std::size_t i = 0; i < reaction_.size(); ++i) node_work_[i] += reaction_[i];
    std::fill(row_work_.begin(), row_work_.end(), 0.0);
    add_compliance(s, 1, to_bound_, row_work_);
    for (std::size_t r = 0; r < clamped_.size(); ++r) {
      if (clamped_[r])
        row_rhs_[r] = -s.row_metric()[r] * to_bound_[r];
      else
        row_rhs_[r] += row_work_[r];
    }
  }
  if (coupling_ != Coupling::none && part_ && (has_gap_ || any_clamped_)) {
    if (!any_clamped_) std::fill(to_bound_.begin(), to_bound_.end(), 0.0);
    part_->add_times(gap_, to_bound_, node_work_);
  }
  for (std::size_t i = 0; i < r_.size(); ++i) node_rhs_[i] = -(r_[i] + node_work_[i]);
  const std::int64_t before = kkt_.dual_iterations(), linear_before = kkt_.linear_iterations();
  const auto clamped =
      any_clamped_ ? std::span<const std::uint8_t>(clamped_) : std::span<const std::uint8_t>();
  const bool ok = coupling_ == Coupling::added
                      ? kkt_.solve_coupled(part_ ? &*part_ : nullptr, clamped, node_rhs_, row_rhs_,
                                           coupled_tolerance_, dx_, lambda_new_, seconds_)
                      : kkt_.solve(node_rhs_, row_rhs_, dx_, lambda_new_, seconds_);
  report.dual_iterations += kkt_.dual_iterations() - before;
  report.linear_iterations += kkt_.linear_iterations() - linear_before;
  report.linear_residual = kkt_.residual();
  for (std::size_t i = 0; i < dx_.size(); ++i) dx_[i] += gap_[i];
  for (std::size_t r = 0; r < theta_.size(); ++r) lambda_new_[r] += lambda[r];
  // What is solved in steps is not exact, but a bound is.
  for (std::size_t r = 0; coupling_ == Coupling::added && any_clamped_ && r < clamped_.size(); ++r) {
    if (clamped_[r]) lambda_new_[r] = bound_[r];
  }
  return ok && std::all_of(dx_.begin(), dx_.end(), finite);
}

// Slope of the merit along the direction; raises gamma until it is safely negative. Also leaves the reactions
// of prescribed coordinates in reaction_.
double Newton::merit_slope(std::span<const double> lambda) {
  const System& s = *system_;
  double q = 0, theta_norm = 0, gap_norm = 0;
  for (std::size_t i = 0; i < dx_.size(); ++i) q -= dot(dx_[i], r_[i]);
  for (std::size_t r = 0; r < theta_.size(); ++r) {
    if (any_clamped_ && clamped_[r]) continue;
    q += theta_[r] * (lambda_new_[r] - lambda[r]);
    theta_norm += theta_[r] * theta_[r] / s.row_metric()[r];
  }
  if (any_clamped_) {
    // Rows held at a bound do not head for theta = 0: the change of theta along the step is taken as it is.
    assembly_.jacobian_times(dx_, row_work_);
    for (std::size_t r = 0; r < theta_.size(); ++r) {
      if (clamped_[r]) q -= row_work_[r] * to_bound_[r];
    }
  }
  if (has_gap_) {
    // r + H dx + G^T dlambda + reaction = 0 at the given directions.
    assembly_.hessian_times(dx_, node_work_);
    if (mass_scale_ > 0) {
      assembly_.mass_times(dx_, inertia_);
      for (std::size_t i = 0; i < dx_.size(); ++i) node_work_[i] += mass_scale_ * inertia_[i];
    }
    for (std::size_t r = 0; r < row_work_.size(); ++r) row_work_[r] = lambda_new_[r] - lambda[r];
    assembly_.constraint_force(row_work_, reaction_);
    for (std::size_t i = 0; i < dx_.size(); ++i) {
      reaction_[i] = -(r_[i] + node_work_[i] + reaction_[i]);
      q -= dot(reaction_[i], gap_[i]);
      gap_norm += stiffness_[i] * dot(gap_[i], gap_[i]);
    }
  }
  const double penalty = theta_norm + gap_norm;
  while (q + gamma_ * penalty < 0.1 * gamma_ * penalty && gamma_ < 1e12) gamma_ *= 4;
  return -q - gamma_ * penalty;
}

// Merit at the trial point held in the assembly, tau along the direction.
double Newton::merit(const SaddleProblem& p, double tau, std::span<const double> lambda_trial) const {
  const System& s = *system_;
  double sum = potential(p, x_trial_) + compliance_energy(s, lambda_trial);
  if (!s.laws().empty()) sum += law_energy_;
  for (std::size_t r = 0; r < theta_.size(); ++r) {
    if (any_clamped_ && clamped_[r]) {
      // max over multipliers within the bounds of multiplier * theta - its distance from the new estimate.
      const double stiffness = gamma_ / s.row_metric()[r];
      const double l = lambda_new_[r];
      const double best = std::clamp(l + stiffness * theta_[r], s.row_lower()[r], s.row_upper()[r]);
      sum += best * theta_[r] - 0.5 * (best - l) * (best - l) / stiffness;
      continue;
    }
    sum += lambda_new_[r] * theta_[r] + 0.5 * gamma_ * theta_[r] * theta_[r] / s.row_metric()[r];
  }
  if (has_gap_) {
    for (std::size_t i = 0; i < dx_.size(); ++i) {
      const Vec3 left = (tau - 1) * gap_[i];
      sum += dot(reaction_[i], left) + 0.5 * gamma_ * stiffness_[i] * dot(left, left);
    }
  }
  return sum;
}

// Moves the trial point to tau along the direction and evaluates there.
double Newton::try_step(const SaddleProblem& p, double tau, std::span<const Vec3> x,
                        std::span<const double> lambda, SaddleReport& report) {
  const Stopwatch watch(seconds_.line_search);
  ++report.trials;
  for (std::size_t i = 0; i < x.size(); ++i) x_trial_[i] = x[i] + tau * dx_[i];
  for (std::size_t r = 0; r < lambda.size(); ++r) {
    lambda_trial_[r] = lambda[r] + tau * (lambda_new_[r] - lambda[r]);
  }
  assembly_.evaluate(Want::gradient, Definiteness::exact, x_trial_, lambda_trial_, p.prescribed);
  assemble_residual(p, x_trial_, lambda_trial_);
  return merit(p, tau, lambda_trial_);
}

// The step at the trial point is taken although the merit refused it: what should turn was stretched on the
// tangent, stiff parts charge for that, and the next Newton step takes it back (the watchdog technique of
// Chamberlain, Powell, Lemarechal & Pedersen 1982). Ventures that fail are followed by shorter ones, and
// three more failures than successes, or one that leaves the domain of the energies, end them for this solve.
// A long way needs several steps back; they go on while each takes most of what is left to pay.
bool Newton::may_venture() const {
  return !venture_.under_way && venture_.failed < most_failed_ventures && !mended_ && !has_gap_ &&
         !any_clamped_ && !system_->has_lag();
}

void Newton::venture(std::span<const Vec3> x, std::span<const double> lambda, double enough, double excess) {
  Venture& v = venture_;
  v.under_way = true;
  v.returns = 0;
  v.excess = excess;
  v.enough = enough;
  v.gamma = gamma_;
  std::copy(x.begin(), x.end(), v.x.begin());
  std::copy(dx_.begin(), dx_.end(), v.dx.begin());
  std::copy(lambda.begin(), lambda.end(), v.lambda.begin());
  std::copy(lambda_new_.begin(), lambda_new_.end(), v.lambda_new.begin());
}

// The Newton step after a venture: where it ends is held against the merit of the venture's start. True when
// that has gone down enough, and x and lambda are there. Otherwise everything is as before the venture, with
// its direction, ready for a search that backtracks.
bool Newton::settle_venture(const SaddleProblem& p, std::span<Vec3> x, std::span<double> lambda,
                            SaddleReport& report) {
  Venture& v = venture_;
  v.under_way = false;
  try_step(p, 1, x, lambda, report);
  std::copy(v.lambda_new.begin(), v.lambda_new.end(), lambda_new_.begin());
  gamma_ = v.gamma;
  const double value = merit(p, 1, lambda_trial_);
  if (value > v.enough && value - v.enough < 0.2 * v.excess && ++v.returns < most_returns) {
    std::copy(x_trial_.begin(), x_trial_.end(), x.begin());
    keep_multipliers(p, x, lambda);
    v.under_way = true;
    v.excess = value - v.enough;
    full_step_ = false;
    return true;
  }
  if (value <= v.enough) {
    std::copy(x_trial_.begin(), x_trial_.end(), x.begin());
    keep_multipliers(p, x, lambda);
    full_step_ = true;
    v.failed = std::max(0, v.failed - 1);
    v.length = std::min(1.0, 1.5 * v.length);
    return true;
  }
  ++v.failed;
  v.length *= 0.4;
  std::copy(v.x.begin(), v.x.end(), x.begin());
  std::copy(v.dx.begin(), v.dx.end(), dx_.begin());
  std::copy(v.lambda.begin(), v.lambda.end(), lambda.begin());
  assembly_.evaluate(Want::gradient, Definiteness::exact, x, lambda, p.prescribed);
  assemble_residual(p, x, lambda);
  return false;
}

// The part of a step up to tau after which no row that its bound has let go is violated too much.
double Newton::longest_step(double tau) {
  const auto most = system_->row_overshoot();
  if (most.empty() || !any_clamped_) return tau;
  assembly_.jacobian_times(dx_, row_work_);
  for (std::size_t r = 0; r < most.size(); ++r) {
    if (!clamped_[r] || !std::isfinite(most[r])) continue;
    // Away from zero, on the side that the bound does not hold.
    const double sign = bound_[r] == system_->row_upper()[r] ? -1 : 1;
    const double way = sign * row_work_[r], left = most[r] - sign * theta_[r];
    if (way * tau > left && left > 0) tau = left / way;
  }
  return tau;
}

// Backtracking to sufficient decrease; a shortened step is then polished by up to two parabolas, because
// evaluations cost a few percent of the factorization that a better step saves.
bool Newton::search(const SaddleProblem& p, std::span<Vec3> x, std::span<double> lambda,
                    SaddleReport& report) {
  const System& s = *system_;
  const double slope = merit_slope(lambda);
  std::copy(x.begin(), x.end(), x_trial_.begin());
  const double start = merit(p, 0, lambda);
  const double noise = 1e-12 * (potential_magnitude(p, x) + std::abs(start));
  const Residuals before = measure(p, x, lambda);
  double longest = 0;
  for (const Vec3& d : dx_) longest = std::max(longest, norm(d));
  double tau = longest > 100 * s.length() ? 100 * s.length() / longest : 1;
  const double most = tau = damping_ * longest_step(tau);
  double value = 0;
  bool accepted = false;
  for (int trial = 0; trial < 40 && tau > 1e-10; ++trial) {
    if (interrupted()) return false;
    value = try_step(p, tau, x, lambda, report);
    if (std::isfinite(value)) {
      accepted = value <= start + 1e-4 * tau * slope;
      // Where the decrease drowns in rounding, the residual decides.
      if (!accepted && std::abs(tau * slope) < 10 * noise && value <= start + 10 * noise) {
        const Residuals after = measure(p, x_trial_, lambda_trial_);
        accepted = after.force <= before.force || after.force < 1e-7;
      }
      if (accepted) break;
      // Only where backtracking would creep.
      if (tau == 1 && parabola_minimum(tau, start, slope, value) < creep && may_venture()) {
        if (venture_.length < 1) {
          tau = venture_.length;
          value = try_step(p, tau, x, lambda, report);
          if (!std::isfinite(value)) continue;
        }
        accepted = value <= start + 1e-4 * tau * slope;
        if (!accepted) {
          const double enough = start + 1e-4 * tau * slope;
          venture(x, lambda, enough, value - enough);
        }
        accepted = true;
        break;
      }
      tau = std::clamp(parabola_minimum(tau, start, slope, value), 0.1 * tau, 0.5 * tau);
    } else {
      tau *= 0.5;
    }
  }
  if (!accepted) return false;
  for (int polish = 0; polish < 2 && tau < most; ++polish) {
    const double next =
        std::min(most, std::clamp(parabola_minimum(tau, start, slope, value), 0.3 * tau, 3 * tau));
    if (std::abs(next - tau) < 0.15 * tau) break;
    const double other = try_step(p, next, x, lambda, report);
    if (!(other < value)) {
      try_step(p, tau, x, lambda, report);
      break;
    }
    value = other;
    tau = next;
  }
  std::copy(x_trial_.begin(), x_trial_.end(), x.begin());
  keep_multipliers(p, x, lambda);
  report.step = tau * longest;
  full_step_ = tau == 1;
  resting_ = resting_ || (has_gap_ && tau < 1);
  // Stencils that follow what is close may have a small jump where what is nearest changes: a search that
  // goes downhill creeps up to it and stays, until they look again.
  creeping_ = tau < (s.renews_stencils() ? 0.01 * most : 1e-3) ? creeping_ + 1 : 0;
  return true;
}

// A prescribed motion that a step could not make whole rests until the body has come after it: what is left
// of the way is asked for again from a state near balance. Otherwise a long way ends at elements about to
// turn over, where no step leads on.
void Newton::rest_gap(const SaddleReport& report) {
  if (!resting_ || !has_gap_) return;
  constexpr double near = 1e-2;
  if (report.force_residual <= near && report.row_residual <= near) {
    resting_ = false;
    return;
  }
  has_gap_ = false;
  std::fill(gap_.begin(), gap_.end(), Vec3{});
}

// Takes over the multipliers of the trial point, projected on their bounds. Those that the projection moved
// change the forces, which are evaluated again.
void Newton::keep_multipliers(const SaddleProblem& p, std::span<const Vec3> x, std::span<double> lambda) {
  std::copy(lambda_trial_.begin(), lambda_trial_.end(), lambda.begin());
  if (!system_->has_bounds()) return;
  clamp(lambda);
  if (std::equal(lambda.begin(), lambda.end(), lambda_trial_.begin())) return;
  assembly_.evaluate(Want::gradient, Definiteness::exact, x, lambda, p.prescribed);
  assemble_residual(p, x, lambda);
}

// Moves the trial point to tau along the direction, multipliers within their bounds, renews the lag and
// evaluates there.
void Newton::try_coupled(const SaddleProblem& p, double tau, std::span<const Vec3> x,
                         std::span<const double> lambda, SaddleReport& report) {
  const Stopwatch watch(seconds_.line_search);
  ++report.trials;
  for (std::size_t i = 0; i < x.size(); ++i) x_trial_[i] = x[i] + tau * dx_[i];
  for (std::size_t r = 0; r < lambda.size(); ++r)
    lambda_trial_[r] = lambda[r] + tau * (lambda_new_[r] - lambda[r]);
  clamp(lambda_trial_);
  assembly_.renew_lag(x_trial_, lambda_trial_, p.prescribed);
  assembly_.evaluate(Want::gradient, Definiteness::exact, x_trial_, lambda_trial_, p.prescribed);
  assemble_residual(p, x_trial_, lambda_trial_);
}

// Corrections are tried from here on.
bool Newton::close_enough(const SaddleReport& report) {
  return report.force_residual <= 1e-2 && report.row_residual <= 1e-2;
}

// Further steps of a system with a lag that know how forces change with it, with the factors at hand,
// symmetric or not. True when the state is in balance. The last evaluation was at x, with a lag of there.
bool Newton::correct_coupled(const SaddleProblem& p, const SaddleOptions& options, std::span<Vec3> x,
                             std::span<double> lambda, SaddleReport& report) {
  constexpr int most = 6;
  const bool adds = coupling_ == Coupling::added;
  bool moved = false;
  for (int k = 0; k < most; ++k) {
    position_gap(p, x);
    if (has_gap_) return false;
    if (adds && part_) part_->evaluate(assembly_, x);
    if (adds && moves_bounds_) {
      choose_clamped(lambda, false);
      // Where it is the very matrix that was factored, its own solve is as exact as a solve can be.
      moved = moved || part_ || !kkt_.holds(clamped_);
      coupling_ = moved ? Coupling::added : Coupling::none;
    }
    if (!direction(lambda, report)) return false;
    const double force = report.force_residual, row = report.row_residual;
    try_coupled(p, 1, x, lambda, report);
    if (!std::isfinite(assembly_.energy())) return false;
    ++report.corrections;
    const bool done = balanced(p, options, x_trial_, lambda_trial_, report);
    if (!pays(force, row, report, options)) return false;
    std::copy(x_trial_.begin(), x_trial_.end(), x.begin());
    std::copy(lambda_trial_.begin(), lambda_trial_.end(), lambda.begin());
    if (done) return true;
  }
  return false;
}

// Close to the solution the factors at hand are as good as new ones for a step or two: a few percent of the
// price. True when the state is in balance. A correction that does not pay is dropped.
bool Newton::correct(const SaddleProblem& p, const SaddleOptions& options, std::span<Vec3> x,
                     std::span<double> lambda, SaddleReport& report) {
  if (!options.corrections || !full_step_ || !close_enough(report)) return false;
  if ((part_ || moves_bounds_) && kkt_.coupled_possible()) {
    if (part_) {
      assembly_.renew_lag(x, lambda, p.prescribed);
      assembly_.evaluate_lagging(Want::gradient, x);
      assemble_residual(p, x, lambda);
      if (balanced(p, options, x, lambda, report)) return true;
    }
    coupling_ = Coupling::added;
    coupled_tolerance_ = correction_tolerance;
    const bool done = correct_coupled(p, options, x, lambda, report);
    coupling_ = Coupling::none;
    // Steep friction may ask for steps that hold the lag instead.
    if (done || !part_ || !kkt_.holds(clamped_)) return done;
  }
  const bool lags = system_->has_lag();
  for (int k = 0; k < (lags ? 12 : 6); ++k) {
    if (lags) {
      assembly_.renew_lag(x, lambda, p.prescribed);
      assembly_.evaluate(Want::gradient, Definiteness::exact, x, lambda, p.prescribed);
      assemble_residual(p, x, lambda);
      if (balanced(p, options, x, lambda, report)) return true;
    }
    position_gap(p, x);
    if (has_gap_ || !direction(lambda, report)) return false;
    const double force = report.force_residual, row = report.row_residual;
    if (!std::isfinite(try_step(p, 1, x, lambda, report))) return false;
    ++report.corrections;
    const bool done = balanced(p, options, x_trial_, lambda_trial_, report);
    if (!pays(force, row, report, options)) return false;
    std::copy(x_trial_.begin(), x_trial_.end(), x.begin());
    keep_multipliers(p, x, lambda);
    if (done && !lags) return true;
  }
  return false;
}

void Newton::begin_search(const SaddleOptions& options) {
  venture_.under_way = false;
  venture_.failed = 0;
  venture_.length = 1;
  resting_ = false;
  creeping_ = 0;
  full_steps_ = 0;
  past_residuals_.fill(0);
  cycle_ = 0;
  damping_ = 1;
  definiteness_ = options.definiteness;
  gamma_ = 0.1;
}

bool Newton::left_all_bounds(std::span<const Vec3> x) const {
  const System& s = *system_;
  const Vec3 origin = s.nodes() > 0 ? s.parts().rest[0] : Vec3{};
  return !std::all_of(x.begin(), x.end(), [&](const Vec3& xi) {
    const Vec3 d = xi - origin;
    return dot(d, d) <= 1e8 * s.length() * s.length();
  });
}

// At the limits; or beyond those of patience while fewer than half of the last eight steps were whole.
// Inertia bounds the energy of an increment from below, however long it is. So a body in motion has an
// equilibrium to arrive at, and a solve whose steps go down in the merit (no set of held rows, no lag that
// may cycle) mostly gets there in less work than the shorter increments would take that replace it.
bool Newton::out_of_patience(const SaddleOptions& o, int iteration, int factorizations) const {
  constexpr int persistence = 5;
  if (o.persistent && mass_scale_ > 0 && !system_->has_bounds() && !system_->has_lag())
    return iteration >= persistence * o.max_iterations ||
           factorizations >= persistence * o.max_factorizations;
  if (iteration >= o.max_iterations || factorizations >= o.max_factorizations) return true;
  if (iteration < o.patient_iterations && factorizations < o.patient_factorizations) return false;
  return std::popcount(full_steps_) < 4;
}

SaddleReport Newton::solve(const SaddleProblem& p, const SaddleOptions& options, std::span<Vec3> x,
                           std::span<double> lambda) {
  SaddleReport report;
  const auto fail = [&](SaddleStatus status) {
    report.status = failed_as(status);
    return report;
  };
  if (!all_finite(p)) return fail(SaddleStatus::not_finite);
  begin(p);
  begin_search(options);
  const System& s = *system_;
  clamp(lambda);
  bool unmended = s.renews_stencils() && p.mass_scale == 0;
  double before = 0;
  for (int iteration = 0;; ++iteration) {
    {
      const Stopwatch watch(seconds_.evaluate);
      assembly_.renew_lag(x, lambda, p.prescribed);
      assembly_.evaluate(Want::hessian, definiteness_, x, lambda, p.prescribed);
      assemble_residual(p, x, lambda);
    }
    if (iteration == 0 && !std::isfinite(assembly_.energy())) return fail(SaddleStatus::not_finite);
    position_gap(p, x);
    rest_gap(report);
    if (interrupted()) return fail(SaddleStatus::cancelled);
    if (out_of_patience(options, iteration, report.factorizations) ||
        report.inner_work() >= options.most_inner_work())
      return fail(SaddleStatus::iteration_limit);
    // A state that is already in balance stays to the last bit.
    if ((iteration == 0 || s.has_lag()) && balanced(p, options, x, lambda, report)) return report;
    if (s.has_bounds()) choose_clamped(lambda, iteration == 0);
    if (!s.laws().empty()) apply_laws(p, lambda, true);
    bool found = false;
    unmended = unmended && (iteration == 0 || (full_step_ && report.force_residual < 0.5 * before));
    before = has_gap_ ? std::numeric_limits<double>::infinity() : report.force_residual;
    if (unmended) found = descend_unmended(p, x, lambda, report);
    if (!found && report.status == SaddleStatus::out_of_memory) return fail(report.status);
    if (!found) {
      if (!factor(p, x, lambda, report)) {
        return fail(report.status == SaddleStatus::converged ? SaddleStatus::singular : report.status);
      }
      found = direction(lambda, report);
    }
    if (!found && kkt_.inertia_was_wrong()) found = factor(p, x, lambda, report) && direction(lambda, report);
    // A backend that cannot tell the inertia is judged by its directions.
    if (report.negative_pivots < 0 && !(found && descends(p, x, lambda))) {
      found = mend_direction(p, x, lambda, report);
    }
    if (!found) return fail(SaddleStatus::singular);
    ++report.iterations;
    if (!(venture_.under_way && settle_venture(p, x, lambda, report)) && !search(p, x, lambda, report))
      return fail(SaddleStatus::line_search_failed);
    full_steps_ = static_cast<std::uint8_t>(full_steps_ << 1 | (full_step_ ? 1 : 0));
    // Steps that short lead nowhere; the work is better spent on a shorter increment, or on other stencils.
    if (creeping_ == 3) return fail(SaddleStatus::line_search_failed);
    const bool done = balanced(p, options, x, lambda, report);
    if (s.has_bounds()) damp_cycles(report);
    if (progress) progress(report.iterations, report.force_residual, report.row_residual);
    // With a lag, balance counts only once it is renewed.
    if ((done && !s.has_lag()) || correct(p, options, x, lambda, report)) return report;
    if (left_all_bounds(x)) return fail(SaddleStatus::diverged);
  }
}

}  // namespace isochor
