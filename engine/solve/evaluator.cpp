#include "engine/solve/evaluator.h"

#include <algorithm>
#include <cmath>

namespace isochor {

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

Evaluator::Evaluator(std::shared_ptr<const System> system, const Parallel& parallel)
    : system_(std::move(system)), assembly_(system_, parallel) {
  const System& s = *system_;
  const std::size_t n = at(s.nodes());
  rest_stiffness_.assign(n, 0);
  way_.resize(n);
  inertia_.resize(n);
  if (!s.laws().empty()) {
    strain_.resize(at(s.rows()));
    tangent_.resize(s.compliance().size());
  }
  calibrate();
}

double Evaluator::apply_laws(const SaddleProblem& p, std::span<const double> lambda, bool tangents) {
  const System& s = *system_;
  double energy = 0;
  for (const auto& law : s.laws()) {
    const RowPool& pool = *s.parts().row_pools[at(law.row_pool)];
    const auto first = at(s.first_row(law.row_pool)), rows = at(pool.rows());
    const auto strain = std::span(strain_).subspan(first, rows);
    energy -= s.evaluate_law(law, p.increment.t0, p.increment.t1, p.memory, lambda, strain,
                             tangents ? std::span(tangent_).subspan(law.first_entry, pool.compliance.size())
                                      : std::span<double>());
    for (std::size_t r = 0; r < rows; ++r) energy += lambda[first + r] * strain[r];
  }
  return energy;
}

void Evaluator::clamp(std::span<double> lambda) const {
  const auto lower = system_->row_lower(), upper = system_->row_upper();
  for (std::size_t r = 0; r < lower.size(); ++r) lambda[r] = std::clamp(lambda[r], lower[r], upper[r]);
}

// Stiffness of the nodes at rest: what forces are compared with. It depends on the scene alone, never on the
// path, so that a run continued from a checkpoint takes the same decisions.
void Evaluator::calibrate() {
  const System& s = *system_;
  const std::vector<double> no_multipliers(at(s.rows()), 0.0), no_loads(at(s.prescribed_rows()), 0.0);
  assembly_.set_increment({});
  assembly_.evaluate(Want::hessian, Definiteness::exact, s.parts().rest, no_multipliers, no_loads);
  assembly_.stiffness_diagonal(rest_stiffness_);
  double largest = 0;
  for (const double k : rest_stiffness_) largest = std::max(largest, k);
  for (double& k : rest_stiffness_) k = std::max(k, 1e-9 * largest);
  stiffness_ = rest_stiffness_;
}

void Evaluator::begin(const SaddleProblem& p) {
  assembly_.set_increment(p.increment, p.memory);
  mass_scale_ = p.mass_scale;
  for (std::size_t i = 0; i < stiffness_.size(); ++i) {
    stiffness_[i] = rest_stiffness_[i] + p.mass_scale * system_->parts().mass[i];
  }
}

void Evaluator::evaluate(const SaddleProblem& p, Want want, Definiteness definiteness, Iterate& it) {
  assembly_.evaluate(want, definiteness, it.x, it.lambda, p.prescribed);
  read_forces(p, it);
  read_rows(p, it);
}

void Evaluator::evaluate_lagging(const SaddleProblem& p, Iterate& it) {
  assembly_.evaluate_lagging(Want::gradient, it.x);
  read_forces(p, it);
  read_rows(p, it);
}

void Evaluator::evaluate_values(const SaddleProblem& p, Iterate& it) {
  assembly_.evaluate(Want::value, Definiteness::exact, it.x, it.lambda, p.prescribed);
  it.energy = assembly_.energy();
  it.absolute_energy = assembly_.absolute_energy();
  it.inertia_energy = 0;
  assembly_.prescribed_row_values(it.prescribed_phi);
  read_rows(p, it);
}

double Evaluator::potential(const SaddleProblem& p, const Iterate& it) const {
  double work = 0, given = 0;
  const auto& rest = system_->parts().rest;
  for (std::size_t i = 0; i < it.x.size(); ++i) work += dot(p.force[i], it.x[i] - rest[i]);
  for (std::size_t r = 0; r < it.prescribed_phi.size(); ++r) given += p.prescribed[r] * it.prescribed_phi[r];
  return it.energy + it.inertia_energy - work + given;
}

double Evaluator::potential_magnitude(const SaddleProblem& p, const Iterate& it) const {
  double sum = it.absolute_energy;
  // However small the strain, an energy is a difference of numbers as large as the stiffness of its element:
  // its rounding error does not vanish with it.
  const double spacing = system_->length() / std::cbrt(static_cast<double>(it.x.size()));
  for (const double k : rest_stiffness_) sum += 1e-3 * k * spacing * spacing;
  const auto& rest = system_->parts().rest;
  for (std::size_t i = 0; i < it.x.size(); ++i) {
    const Vec3 u = it.x[i] - rest[i];
    sum += norm(p.force[i]) * norm(u);
    if (p.mass_scale > 0) {
      const Vec3 d = it.x[i] - p.predicted[i];
      sum += 0.5 * p.mass_scale * system_->parts().mass[i] * dot(d, d);
    }
  }
  for (std::size_t r = 0; r < it.prescribed_phi.size(); ++r)
    sum += std::abs(p.prescribed[r] * it.prescribed_phi[r]);
  return sum;
}

void Evaluator::read_forces(const SaddleProblem& p, Iterate& it) {
  it.energy = assembly_.energy();
  it.absolute_energy = assembly_.absolute_energy();
  assembly_.residual(it.force);
  assembly_.residual_magnitude(it.magnitude);
  for (std::size_t i = 0; i < it.force.size(); ++i) {
    it.force[i] -= p.force[i];
    it.magnitude[i] += norm(p.force[i]);
  }
  it.inertia_energy = 0;
  if (p.mass_scale > 0) {
    for (std::size_t i = 0; i < it.force.size(); ++i) way_[i] = it.x[i] - p.predicted[i];
    assembly_.mass_times(way_, inertia_);
    for (std::size_t i = 0; i < it.force.size(); ++i) {
      const Vec3 f = p.mass_scale * inertia_[i];
      it.inertia_energy += 0.5 * dot(f, way_[i]);
      it.force[i] += f;
      it.magnitude[i] += norm(f);
    }
  }
  assembly_.prescribed_row_values(it.prescribed_phi);
}

void Evaluator::read_rows(const SaddleProblem& p, Iterate& it) {
  const System& s = *system_;
  assembly_.row_values(it.theta);
  for (std::size_t r = 0; r < it.theta.size(); ++r) it.theta[r] -= p.target[r];
  add_compliance(s, -1, it.lambda, it.theta);
  if (s.laws().empty()) return;
  it.law_energy = apply_laws(p, it.lambda, false);
  for (const auto& law : s.laws()) {
    const auto first = s.first_row(law.row_pool), rows = s.parts().row_pools[at(law.row_pool)]->rows();
    for (Index r = first; r < first + rows; ++r) it.theta[at(r)] -= strain_[at(r)];
  }
}

Evaluator::RowResiduals Evaluator::measure_rows(const SaddleProblem& p, const Iterate& it) const {
  const System& s = *system_;
  double row = 0, position = 0;
  if (s.has_bounds()) {
    // What the projection leaves over: zero when the row is met, or when its multiplier sits at the bound
    // that theta pushes it against.
    for (std::size_t r = 0; r < it.theta.size(); ++r) {
      const double d = s.row_metric()[r];
      const double projected = std::clamp(it.lambda[r] + it.theta[r] / d, s.row_lower()[r], s.row_upper()[r]);
      row = std::max(row, d * std::abs(projected - it.lambda[r]) / s.row_measure()[r]);
    }
  } else {
    for (std::size_t r = 0; r < it.theta.size(); ++r)
      row = std::max(row, std::abs(it.theta[r]) / s.row_measure()[r]);
  }
  if (s.has_prescribers()) {
    for (Index i = 0; i < s.nodes(); ++i) {
      const Index b = s.basis_of()[at(i)];
      if (b < 0) continue;
      const FreeBasis& basis = s.free_bases()[at(b)];
      const Vec3 q = transposed_times(basis.directions, p.position[at(b)] - it.x[at(i)]);
      for (int c = basis.count; c < 3; ++c) position = std::max(position, std::abs(q[c]));
    }
  }
  return {row, s.length() > 0 ? position / s.length() : position};
}

Evaluator::Residuals Evaluator::measure(const SaddleProblem& p, const Iterate& it) const {
  const System& s = *system_;
  double force = 0, reference = 0;
  // Far from the origin, coordinates have fewer digits to tell a deformation by.
  double farthest = 0;
  for (const Vec3& at_node : it.x) farthest = std::max(farthest, dot(at_node, at_node));
  const double floor = 1e-6 * std::max(s.length(), std::sqrt(farthest));
  for (Index i = 0; i < s.nodes(); ++i) {
    const double k = stiffness_[at(i)];
    if (k <= 0) continue;
    Vec3 free = it.force[at(i)];
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
    const double size = std::max(it.magnitude[at(i)], k * floor);
    reference += size * size / k;
  }
  const double relative = reference > 0 ? std::sqrt(force / reference) : 0;
  const RowResiduals rows = measure_rows(p, it);
  return {relative, rows.row, rows.position};
}

bool Evaluator::balanced(const SaddleProblem& p, const SaddleOptions& o, const Iterate& it,
                         SaddleReport& report) const {
  const Residuals r = measure(p, it);
  report.force_residual = r.force;
  report.row_residual = r.row;
  return r.force <= o.force_tolerance && r.row <= o.row_tolerance && r.position <= o.position_tolerance;
}

StoredEnergy Evaluator::stored(const SaddleProblem& p, const Iterate& it) const {
  constexpr double rows_met = 1e-8, positions_met = 1e-11;
  StoredEnergy s;
  const double compliance = compliance_energy(*system_, it.lambda);
  s.energy = potential(p, it) - it.inertia_energy + compliance;
  if (!system_->laws().empty()) s.energy += it.law_energy;
  s.elastic = it.absolute_energy + compliance;
  s.noise = 1e-12 * potential_magnitude(p, it);
  const RowResiduals rows = measure_rows(p, it);
  s.row = rows.row;
  s.met = rows.row <= rows_met && rows.position <= positions_met;
  return s;
}

void Evaluator::add_inertia_of_gap(const Gap& gap, std::span<Vec3> y) {
  if (system_->block_mass().empty() || mass_scale_ == 0) return;
  assembly_.mass_times(gap.way, inertia_);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] += mass_scale_ * inertia_[i];
}

void Evaluator::find_gap(const SaddleProblem& p, std::span<const Vec3> x, Gap& gap) const {
  gap.open = false;
  const System& s = *system_;
  std::fill(gap.way.begin(), gap.way.end(), Vec3{});
  if (!s.has_prescribers()) return;
  for (Index i = 0; i < s.nodes(); ++i) {
    const Index b = s.basis_of()[at(i)];
    if (b < 0) continue;
    const FreeBasis& basis = s.free_bases()[at(b)];
    Vec3 q = transposed_times(basis.directions, p.position[at(b)] - x[at(i)]);
    for (int c = 0; c < basis.count; ++c) q[c] = 0;
    gap.way[at(i)] = basis.directions * q;
    if (dot(gap.way[at(i)], gap.way[at(i)]) > 0) gap.open = true;
  }
}

}  // namespace isochor
