#include "engine/saddle_point.h"

#include <algorithm>
#include <cmath>

namespace isochor {

bool all_finite(const SaddleProblem& p) {
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

std::string_view to_string(SaddleStatus status) {
  switch (status) {
    case SaddleStatus::converged:
      return "converged";
    case SaddleStatus::iteration_limit:
      return "iteration limit reached";
    case SaddleStatus::line_search_failed:
      return "line search found no descent";
    case SaddleStatus::singular:
      return "saddle-point matrix is singular";
    case SaddleStatus::diverged:
      return "positions diverged";
    case SaddleStatus::not_finite:
      return "not a finite number";
    case SaddleStatus::cancelled:
      return "cancelled";
    case SaddleStatus::out_of_memory:
      return "out of memory";
    case SaddleStatus::passed_through:
      return "nodes passed through an obstacle";
  }
  return "unknown";
}

SaddlePoint::SaddlePoint(std::shared_ptr<const System> system, const Parallel& parallel,
                         std::unique_ptr<LinearSolver> solver)
    : system_(std::move(system)), assembly_(system_, parallel), kkt_(system_, parallel, std::move(solver)) {
  const System& s = *system_;
  const std::size_t n = at(s.nodes()), m = at(s.rows());
  theta_.resize(m);
  prescribed_phi_.resize(at(s.prescribed_rows()));
  magnitude_.resize(n);
  rest_stiffness_.assign(n, 0);
  stiffness_.resize(n);
  r_.resize(n);
  gap_.resize(n);
  if (!s.laws().empty()) {
    strain_.resize(m);
    tangent_.resize(s.compliance().size());
  }
  calibrate();
}

// Strains of the rows with a law of their own, and their tangents where asked; returns their energy
// lambda . c - U.
double SaddlePoint::apply_laws(const SaddleProblem& p, std::span<const double> lambda, bool tangents) {
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

void SaddlePoint::clamp(std::span<double> lambda) const {
  const auto lower = system_->row_lower(), upper = system_->row_upper();
  for (std::size_t r = 0; r < lower.size(); ++r) lambda[r] = std::clamp(lambda[r], lower[r], upper[r]);
}

// Stiffness of the nodes at rest: what forces are compared with. It depends on the scene alone, never on the
// path, so that a run continued from a checkpoint takes the same decisions.
void SaddlePoint::calibrate() {
  const System& s = *system_;
  const std::vector<double> no_multipliers(at(s.rows()), 0.0), no_loads(at(s.prescribed_rows()), 0.0);
  assembly_.evaluate(Want::hessian, Definiteness::exact, s.parts().rest, no_multipliers, no_loads);
  assembly_.stiffness_diagonal(rest_stiffness_);
  double largest = 0;
  for (const double k : rest_stiffness_) largest = std::max(largest, k);
  for (double& k : rest_stiffness_) k = std::max(k, 1e-9 * largest);
  stiffness_ = rest_stiffness_;
}

double SaddlePoint::potential(const SaddleProblem& p, std::span<const Vec3> x) const {
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
double SaddlePoint::potential_magnitude(const SaddleProblem& p, std::span<const Vec3> x) const {
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
void SaddlePoint::assemble_residual(const SaddleProblem& p, std::span<const Vec3> x,
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

SaddlePoint::Residuals SaddlePoint::measure(const SaddleProblem& p, std::span<const Vec3> x,
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
bool SaddlePoint::balanced(const SaddleProblem& p, const SaddleOptions& o, std::span<const Vec3> x,
                           std::span<const double> lambda, SaddleReport& report) const {
  const Residuals r = measure(p, x, lambda);
  report.force_residual = r.force;
  report.row_residual = r.row;
  return r.force <= o.force_tolerance && r.row <= o.row_tolerance && r.position <= o.position_tolerance;
}

void SaddlePoint::position_gap(const SaddleProblem& p, std::span<const Vec3> x) {
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

}  // namespace isochor
