#include "engine/newton.h"

#include <algorithm>
#include <cmath>

namespace isochor {

namespace {

double norm(const Vec3& v) {
  return std::sqrt(dot(v, v));
}
bool finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool all_finite(const NewtonProblem& p) {
  const auto ok = [](double v) { return std::isfinite(v); };
  return std::all_of(p.force.begin(), p.force.end(), finite) &&
         std::all_of(p.position.begin(), p.position.end(), finite) &&
         std::all_of(p.target.begin(), p.target.end(), ok) &&
         std::all_of(p.prescribed.begin(), p.prescribed.end(), ok) &&
         std::all_of(p.memory.begin(), p.memory.end(), ok) && std::isfinite(p.mass_scale) &&
         (p.mass_scale == 0 || std::all_of(p.predicted.begin(), p.predicted.end(), finite));
}

// y += alpha * C v over the compliance entries.
void add_compliance(const System& s, double alpha, std::span<const double> v, std::span<double> y) {
  for (const ComplianceEntry& e : s.compliance()) {
    y[at(e.row)] += alpha * e.value * v[at(e.col)];
    if (e.row != e.col) y[at(e.col)] += alpha * e.value * v[at(e.row)];
  }
}

double compliance_energy(const System& s, std::span<const double> v) {
  double sum = 0;
  for (const ComplianceEntry& e : s.compliance()) {
    const double product = e.value * v[at(e.row)] * v[at(e.col)];
    sum += e.row == e.col ? 0.5 * product : product;
  }
  return sum;
}

// Where the parabola through the start, its slope and one value has its minimum.
double parabola_minimum(double tau, double start, double slope, double value) {
  const double curvature = value - start - slope * tau;
  return curvature > 0 ? -0.5 * slope * tau * tau / curvature : 3 * tau;
}

}  // namespace

std::string_view to_string(NewtonStatus status) {
  switch (status) {
    case NewtonStatus::converged:
      return "converged";
    case NewtonStatus::iteration_limit:
      return "iteration limit reached";
    case NewtonStatus::line_search_failed:
      return "line search found no descent";
    case NewtonStatus::singular:
      return "saddle-point matrix is singular";
    case NewtonStatus::diverged:
      return "positions diverged";
    case NewtonStatus::not_finite:
      return "not a finite number";
    case NewtonStatus::cancelled:
      return "cancelled";
    case NewtonStatus::out_of_memory:
      return "out of memory";
  }
  return "unknown";
}

Newton::Newton(std::shared_ptr<const System> system, const Parallel& parallel,
               std::unique_ptr<LinearSolver> solver)
    : system_(std::move(system)), assembly_(system_, parallel), kkt_(system_, parallel, std::move(solver)) {
  const System& s = *system_;
  const std::size_t n = at(s.nodes()), m = at(s.rows());
  row_rhs_.resize(m);
  node_rhs_.resize(n);
  theta_.resize(m);
  row_work_.resize(m);
  lambda_new_.resize(m);
  lambda_trial_.resize(m);
  prescribed_phi_.resize(at(s.prescribed_rows()));
  magnitude_.resize(n);
  rest_stiffness_.assign(n, 0);
  stiffness_.resize(n);
  r_.resize(n);
  dx_.resize(n);
  gap_.resize(n);
  node_work_.resize(n);
  x_trial_.resize(n);
  reaction_.resize(n);
  if (!s.laws().empty()) {
    strain_.resize(m);
    tangent_.resize(s.compliance().size());
  }
  if (s.has_bounds()) {
    clamped_.assign(m, 0);
    bound_.assign(m, 0);
    to_bound_.assign(m, 0);
  }
  calibrate();
}

// Strains of the rows with a law of their own, and their tangents where asked; returns their energy
// lambda . c - U.
double Newton::apply_laws(const NewtonProblem& p, std::span<const double> lambda, bool tangents) {
  const System& s = *system_;
  double energy = 0;
  for (const auto& [index, entry] : s.laws()) {
    const RowPool& pool = *s.parts().row_pools[at(index)];
    const auto first = at(s.first_row(index)), rows = at(pool.rows());
    const RowIncrement increment{
        p.t0, p.t1, p.memory.subspan(at(s.first_memory(index)), static_cast<std::size_t>(pool.memory()))};
    const auto l = lambda.subspan(first, rows);
    const auto strain = std::span(strain_).subspan(first, rows);
    energy -= pool.evaluate_law(
        increment, l, strain,
        tangents ? std::span(tangent_).subspan(entry, pool.compliance.size()) : std::span<double>());
    for (std::size_t r = 0; r < rows; ++r) energy += l[r] * strain[r];
  }
  return energy;
}

void Newton::clamp(std::span<double> lambda) const {
  const auto lower = system_->row_lower(), upper = system_->row_upper();
  for (std::size_t r = 0; r < lower.size(); ++r) lambda[r] = std::clamp(lambda[r], lower[r], upper[r]);
}

// The active set of the primal-dual active-set method: a row whose multiplier would leave its bounds under
// the force law lambda + theta / metric is held at the bound in this linear system (Hintermueller, Ito &
// Kunisch 2002).
void Newton::choose_clamped(std::span<const double> lambda) {
  const System& s = *system_;
  const auto lower = s.row_lower(), upper = s.row_upper();
  any_clamped_ = false;
  for (std::size_t r = 0; r < clamped_.size(); ++r) {
    const double trial = lambda[r] + theta_[r] / s.row_metric()[r];
    clamped_[r] = trial <= lower[r] || trial >= upper[r];
    if (clamped_[r]) bound_[r] = trial <= lower[r] ? lower[r] : upper[r];
    any_clamped_ = any_clamped_ || clamped_[r];
  }
}

// Stiffness of the nodes at rest: what forces are compared with. It depends on the scene alone, never on the
// path, so that a run continued from a checkpoint takes the same decisions.
void Newton::calibrate() {
  const System& s = *system_;
  std::fill(lambda_trial_.begin(), lambda_trial_.end(), 0.0);
  const std::vector<double> none(at(s.prescribed_rows()), 0.0);
  assembly_.evaluate(Want::hessian, Definiteness::exact, s.parts().rest, lambda_trial_, none);
  assembly_.stiffness_diagonal(rest_stiffness_);
  double largest = 0;
  for (const double k : rest_stiffness_) largest = std::max(largest, k);
  for (double& k : rest_stiffness_) k = std::max(k, 1e-9 * largest);
  stiffness_ = rest_stiffness_;
}

double Newton::potential(const NewtonProblem& p, std::span<const Vec3> x) const {
  const System& s = *system_;
  double inertia = 0, work = 0, given = 0;
  const auto& rest = s.parts().rest;
  for (std::size_t i = 0; i < x.size(); ++i) work += dot(p.force[i], x[i] - rest[i]);
  if (p.mass_scale > 0) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3 d = x[i] - p.predicted[i];
      inertia += s.parts().mass[i] * dot(d, d);
    }
  }
  for (std::size_t r = 0; r < prescribed_phi_.size(); ++r) given += p.prescribed[r] * prescribed_phi_[r];
  return assembly_.energy() + 0.5 * p.mass_scale * inertia - work + given;
}

// Size of the numbers that cancel in the potential: what its rounding error is relative to.
double Newton::potential_magnitude(const NewtonProblem& p, std::span<const Vec3> x) const {
  double sum = assembly_.absolute_energy();
  // However small the strain, an energy is a difference of numbers as large as the stiffness of its element:
  // its rounding error does not vanish with it.
  const double spacing = system_->length() / std::cbrt(static_cast<double>(x.size()));
  for (const double k : rest_stiffness_) sum += 1e-3 * k * spacing * spacing;
  const auto& rest = system_->parts().rest;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 u = x[i] - rest[i];
    sum += norm(p.force[i]) * norm(u);
    if (p.mass_scale > 0) {
      const Vec3 d = x[i] - p.predicted[i];
      sum += 0.5 * p.mass_scale * system_->parts().mass[i] * dot(d, d);
    }
  }
  for (std::size_t r = 0; r < prescribed_phi_.size(); ++r)
    sum += std::abs(p.prescribed[r] * prescribed_phi_[r]);
  return sum;
}

// Residuals of the last evaluation: r = dE/dx + G^T lambda over all nodes, theta = phi - target - C lambda.
void Newton::assemble_residual(const NewtonProblem& p, std::span<const Vec3> x,
                               std::span<const double> lambda) {
  const System& s = *system_;
  assembly_.residual(r_);
  assembly_.residual_magnitude(magnitude_);
  for (std::size_t i = 0; i < r_.size(); ++i) {
    r_[i] -= p.force[i];
    magnitude_[i] += norm(p.force[i]);
    if (p.mass_scale > 0) {
      const double c = p.mass_scale * s.parts().mass[i];
      const Vec3 f = c * (x[i] - p.predicted[i]);
      r_[i] += f;
      magnitude_[i] += norm(f);
    }
  }
  assembly_.row_values(theta_);
  for (std::size_t r = 0; r < theta_.size(); ++r) theta_[r] -= p.target[r];
  add_compliance(s, -1, lambda, theta_);
  if (!s.laws().empty()) {
    law_energy_ = apply_laws(p, lambda, false);
    for (const auto& law : s.laws()) {
      const auto first = s.first_row(law.row_pool), rows = s.parts().row_pools[at(law.row_pool)]->rows();
      for (Index r = first; r < first + rows; ++r) theta_[at(r)] -= strain_[at(r)];
    }
  }
  assembly_.prescribed_row_values(prescribed_phi_);
}

Newton::Residuals Newton::measure(const NewtonProblem& p, std::span<const Vec3> x,
                                  std::span<const double> lambda) const {
  const System& s = *system_;
  double force = 0, reference = 0, row = 0, position = 0;
  const double floor = 1e-6 * s.length();
  for (Index i = 0; i < s.nodes(); ++i) {
    const double k = stiffness_[at(i)];
    if (k <= 0) continue;
    Vec3 free = r_[at(i)];
    const Index b = s.basis_of()[at(i)];
    if (b >= 0) {
      const FreeBasis& basis = s.free_bases()[at(b)];
      const Vec3 q = transposed_times(basis.directions, free);
      double sum = 0;
      for (int c = 0; c < basis.count; ++c) sum += q[c] * q[c];
      force += sum / k;
    } else {
      force += dot(free, free) / k;
    }
    const double size = std::max(magnitude_[at(i)], k * floor);
    reference += size * size / k;
  }
  if (s.has_bounds()) {
    // What the projection leaves over: zero when the row is met, or when its multiplier sits at the bound
    // that theta pushes it against.
    for (std::size_t r = 0; r < theta_.size(); ++r) {
      const double d = s.row_metric()[r];
      const double projected = std::clamp(lambda[r] + theta_[r] / d, s.row_lower()[r], s.row_upper()[r]);
      row = std::max(row, d * std::abs(projected - lambda[r]) / s.row_measure()[r]);
    }
  } else {
    for (std::size_t r = 0; r < theta_.size(); ++r)
      row = std::max(row, std::abs(theta_[r]) / s.row_measure()[r]);
  }
  if (s.has_prescribers()) {
    for (Index i = 0; i < s.nodes(); ++i) {
      const Index b = s.basis_of()[at(i)];
      if (b < 0) continue;
      const FreeBasis& basis = s.free_bases()[at(b)];
      const Vec3 q = transposed_times(basis.directions, p.position[at(b)] - x[at(i)]);
      for (int c = basis.count; c < 3; ++c) position = std::max(position, std::abs(q[c]));
    }
  }
  const double relative = reference > 0 ? std::sqrt(force / reference) : 0;
  return {relative, row, s.length() > 0 ? position / s.length() : position};
}

// Writes the residuals of the last evaluation into the report and says whether they are within tolerance.
bool Newton::balanced(const NewtonProblem& p, const NewtonOptions& o, std::span<const Vec3> x,
                      std::span<const double> lambda, NewtonReport& report) const {
  const Residuals r = measure(p, x, lambda);
  report.force_residual = r.force;
  report.row_residual = r.row;
  return r.force <= o.force_tolerance && r.row <= o.row_tolerance && r.position <= o.position_tolerance;
}

void Newton::position_gap(const NewtonProblem& p, std::span<const Vec3> x) {
  has_gap_ = false;
  const System& s = *system_;
  std::fill(gap_.begin(), gap_.end(), Vec3{});
  if (!s.has_prescribers()) return;
  for (Index i = 0; i < s.nodes(); ++i) {
    const Index b = s.basis_of()[at(i)];
    if (b < 0) continue;
    const FreeBasis& basis = s.free_bases()[at(b)];
    Vec3 q = transposed_times(basis.directions, p.position[at(b)] - x[at(i)]);
    for (int c = 0; c < basis.count; ++c) q[c] = 0;
    gap_[at(i)] = basis.directions * q;
    if (dot(gap_[at(i)], gap_[at(i)]) > 0) has_gap_ = true;
  }
}

// Assembles and factors; mends a wrong inertia by a shift of the displacement block, small at first, and when
// that grows out of proportion by the stencils' projected Hessians.
bool Newton::factor(const NewtonProblem& p, std::span<const Vec3> x, std::span<const double> lambda,
                    NewtonReport& report) {
  if (factor_shifted(p.mass_scale, 0, report)) return true;
  if (report.status == NewtonStatus::out_of_memory) return false;
  ++report.shifted;
  // Starting from a third of what the last wrong inertia took finds the size in one or two trials.
  double shift = shift_ > 0 ? std::max(1e-4, shift_ / 3) : 1e-3;
  for (; shift < 1; shift *= 6) {
    if (factor_shifted(p.mass_scale, shift, report)) {
      shift_ = shift;
      return true;
    }
    if (report.status == NewtonStatus::out_of_memory) return false;
  }
  {
    const Stopwatch watch(seconds_.evaluate);
    assembly_.evaluate(Want::hessian, Definiteness::projected, x, lambda, p.prescribed);
  }
  ++report.projected;
  for (shift = 0; shift < 1e3; shift = std::max(1e-3, 30 * shift)) {
    if (factor_shifted(p.mass_scale, shift, report)) return true;
    if (report.status == NewtonStatus::out_of_memory) return false;
  }
  report.status = NewtonStatus::singular;
  return false;
}

bool Newton::factor_shifted(double mass_scale, double shift, NewtonReport& report) {
  Kkt::Values values;
  values.mass_scale = mass_scale;
  values.shift = shift;
  values.stiffness = stiffness_;
  values.tangent = tangent_;
  if (any_clamped_) values.clamped = clamped_;
  const Kkt::Outcome f = kkt_.factor(assembly_, values, seconds_);
  ++report.factorizations;
  report.negative_pivots = f.negative;
  if (f.status == FactorStatus::out_of_memory) report.status = NewtonStatus::out_of_memory;
  if (f.status != FactorStatus::ok) {
    report.message = f.message;
    return false;
  }
  return f.negative < 0 || f.negative == system_->rows();
}

// Solves for (dx, dlambda); prescribed coordinates move by their whole gap, multipliers held at a bound by
// the rest of their way there.
bool Newton::direction(std::span<const double> lambda, NewtonReport& report) {
  const System& s = *system_;
  if (has_gap_) {
    assembly_.hessian_times(gap_, node_work_);
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
  for (std::size_t i = 0; i < r_.size(); ++i) node_rhs_[i] = -(r_[i] + node_work_[i]);
  const bool ok = kkt_.solve(node_rhs_, row_rhs_, dx_, lambda_new_, seconds_);
  report.linear_residual = kkt_.residual();
  for (std::size_t i = 0; i < dx_.size(); ++i) dx_[i] += gap_[i];
  for (std::size_t r = 0; r < theta_.size(); ++r) lambda_new_[r] += lambda[r];
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
double Newton::merit(const NewtonProblem& p, double tau, std::span<const double> lambda_trial) const {
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
double Newton::try_step(const NewtonProblem& p, double tau, std::span<const Vec3> x,
                        std::span<const double> lambda, NewtonReport& report) {
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

// Backtracking to sufficient decrease; a shortened step is then polished by up to two parabolas, because
// evaluations cost a few percent of the factorization that a better step saves.
bool Newton::search(const NewtonProblem& p, std::span<Vec3> x, std::span<double> lambda,
                    NewtonReport& report) {
  const System& s = *system_;
  const double slope = merit_slope(lambda);
  std::copy(x.begin(), x.end(), x_trial_.begin());
  const double start = merit(p, 0, lambda);
  const double noise = 1e-12 * (potential_magnitude(p, x) + std::abs(start));
  const Residuals before = measure(p, x, lambda);
  double longest = 0;
  for (const Vec3& d : dx_) longest = std::max(longest, norm(d));
  double tau = longest > 100 * s.length() ? 100 * s.length() / longest : 1;
  double value = 0;
  bool accepted = false;
  for (int trial = 0; trial < 40 && tau > 1e-10; ++trial) {
    value = try_step(p, tau, x, lambda, report);
    if (std::isfinite(value)) {
      accepted = value <= start + 1e-4 * tau * slope;
      // Where the decrease drowns in rounding, the residual decides.
      if (!accepted && std::abs(tau * slope) < 10 * noise && value <= start + 10 * noise) {
        const Residuals after = measure(p, x_trial_, lambda_trial_);
        accepted = after.force <= before.force || after.force < 1e-7;
      }
      if (accepted) break;
      tau = std::clamp(parabola_minimum(tau, start, slope, value), 0.1 * tau, 0.5 * tau);
    } else {
      tau *= 0.5;
    }
  }
  if (!accepted) return false;
  for (int polish = 0; polish < 2 && tau < 1; ++polish) {
    const double next =
        std::min(1.0, std::clamp(parabola_minimum(tau, start, slope, value), 0.3 * tau, 3 * tau));
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
  return true;
}

// Takes over the multipliers of the trial point, projected on their bounds. Those that the projection moved
// change the forces, which are evaluated again.
void Newton::keep_multipliers(const NewtonProblem& p, std::span<const Vec3> x, std::span<double> lambda) {
  std::copy(lambda_trial_.begin(), lambda_trial_.end(), lambda.begin());
  if (!system_->has_bounds()) return;
  clamp(lambda);
  if (std::equal(lambda.begin(), lambda.end(), lambda_trial_.begin())) return;
  assembly_.evaluate(Want::gradient, Definiteness::exact, x, lambda, p.prescribed);
  assemble_residual(p, x, lambda);
}

// Close to the solution the factors at hand are as good as new ones for a step or two: a few percent of the
// price. True when the state is in balance. A correction that does not pay is dropped.
bool Newton::correct(const NewtonProblem& p, const NewtonOptions& options, std::span<Vec3> x,
                     std::span<double> lambda, NewtonReport& report) {
  constexpr double worthwhile = 0.3;  // less of a reduction and a new factorization is the better buy
  if (!full_step_ || report.force_residual > 1e-2 || report.row_residual > 1e-2) return false;
  for (int k = 0; k < 6; ++k) {
    position_gap(p, x);
    if (has_gap_ || !direction(lambda, report)) return false;
    const double force = report.force_residual, row = report.row_residual;
    if (!std::isfinite(try_step(p, 1, x, lambda, report))) return false;
    ++report.corrections;
    const bool done = balanced(p, options, x_trial_, lambda_trial_, report);
    const bool pays = report.force_residual <= std::max(worthwhile * force, options.force_tolerance) &&
                      report.row_residual <= std::max(worthwhile * row, options.row_tolerance);
    if (!pays) return false;
    std::copy(x_trial_.begin(), x_trial_.end(), x.begin());
    keep_multipliers(p, x, lambda);
    if (done) return true;
  }
  return false;
}

NewtonReport Newton::solve(const NewtonProblem& p, const NewtonOptions& options, std::span<Vec3> x,
                           std::span<double> lambda) {
  NewtonReport report;
  const auto fail = [&](NewtonStatus status) {
    report.status = status;
    return report;
  };
  if (!all_finite(p)) return fail(NewtonStatus::not_finite);
  // Results are read without an increment.
  struct Increment {
    Assembly& assembly;
    ~Increment() { assembly.set_increment({}); }
  } const of_this_solve{assembly_};
  assembly_.set_increment(p.increment);
  gamma_ = 0.1;
  shift_ = 0;
  for (std::size_t i = 0; i < stiffness_.size(); ++i) {
    stiffness_[i] = rest_stiffness_[i] + p.mass_scale * system_->parts().mass[i];
  }
  const System& s = *system_;
  any_clamped_ = false;
  clamp(lambda);
  const Vec3 origin = s.nodes() > 0 ? s.parts().rest[0] : Vec3{};
  for (int iteration = 0;; ++iteration) {
    {
      const Stopwatch watch(seconds_.evaluate);
      assembly_.evaluate(Want::hessian, Definiteness::exact, x, lambda, p.prescribed);
      assemble_residual(p, x, lambda);
    }
    if (iteration == 0 && !std::isfinite(assembly_.energy())) return fail(NewtonStatus::not_finite);
    position_gap(p, x);
    if (cancelled && cancelled()) return fail(NewtonStatus::cancelled);
    if (iteration >= options.max_iterations || report.factorizations >= options.max_factorizations) {
      return fail(NewtonStatus::iteration_limit);
    }
    // A state that is already in balance stays to the last bit.
    if (iteration == 0 && balanced(p, options, x, lambda, report)) return report;
    if (s.has_bounds()) choose_clamped(lambda);
    if (!s.laws().empty()) apply_laws(p, lambda, true);
    if (!factor(p, x, lambda, report)) {
      return fail(report.status == NewtonStatus::converged ? NewtonStatus::singular : report.status);
    }
    if (!direction(lambda, report)) return fail(NewtonStatus::singular);
    ++report.iterations;
    if (!search(p, x, lambda, report)) return fail(NewtonStatus::line_search_failed);
    const bool done = balanced(p, options, x, lambda, report);
    if (progress) progress(report.iterations, report.force_residual, report.row_residual);
    if (done || correct(p, options, x, lambda, report)) return report;
    for (const Vec3& xi : x) {
      const Vec3 d = xi - origin;
      if (!(dot(d, d) <= 1e8 * s.length() * s.length())) return fail(NewtonStatus::diverged);
    }
  }
}

}  // namespace isochor
