#include "engine/solve/saddle_point.h"

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
    case SaddleStatus::inadmissible:
      return "the solution is no admissible state";
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
  way_.resize(n);
  inertia_.resize(n);
  if (!s.laws().empty()) {
    strain_.resize(m);
    tangent_.resize(s.compliance().size());
  }
  if (s.has_bounds()) clamped_.assign(m, 0);
  calibrate();
}

// Strains of the rows with a law of their own, and their tangents where asked; returns their energy
// lambda . c - U.
double SaddlePoint::apply_laws(const SaddleProblem& p, std::span<const double> lambda, bool tangents) {
  const System& s = *system_;
  double energy = 0;
  for (const auto& law : s.laws()) {
    const RowPool& pool = *s.parts().row_pools[at(law.row_pool)];
    const auto first = at(s.first_row(law.row_pool)), rows = at(pool.rows());
    const auto strain = std::span(strain_).subspan(first, rows);
    energy -= s.evaluate_law(law, p.t0, p.t1, p.memory, lambda, strain,
                             tangents ? std::span(tangent_).subspan(law.first_entry, pool.compliance.size())
                                      : std::span<double>());
    for (std::size_t r = 0; r < rows; ++r) energy += lambda[first + r] * strain[r];
  }
  return energy;
}

void SaddlePoint::set_interrupt(std::function<bool()> asked) {
  kkt_.set_interrupt(asked);
  cancelled_ = std::move(asked);
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
  double work = 0, given = 0;
  const auto& rest = system_->parts().rest;
  for (std::size_t i = 0; i < x.size(); ++i) work += dot(p.force[i], x[i] - rest[i]);
  for (std::size_t r = 0; r < prescribed_phi_.size(); ++r) given += p.prescribed[r] * prescribed_phi_[r];
  return assembly_.energy() + inertia_energy_ - work + given;
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

void SaddlePoint::begin(const SaddleProblem& p) {
  kkt_.linear_solver().begin_solve();
  assembly_.set_increment(p.increment, p.memory);
  shift_ = 0;
  trace_ = 0;
  any_clamped_ = false;
  mass_scale_ = p.mass_scale;
  for (std::size_t i = 0; i < stiffness_.size(); ++i) {
    stiffness_[i] = rest_stiffness_[i] + p.mass_scale * system_->parts().mass[i];
  }
}

// Of the last evaluation: r = dE/dx + G^T lambda over all nodes.
void SaddlePoint::force_residual(const SaddleProblem& p, std::span<const Vec3> x) {
  assembly_.residual(r_);
  assembly_.residual_magnitude(magnitude_);
  for (std::size_t i = 0; i < r_.size(); ++i) {
    r_[i] -= p.force[i];
    magnitude_[i] += norm(p.force[i]);
  }
  inertia_energy_ = 0;
  if (p.mass_scale > 0) {
    for (std::size_t i = 0; i < r_.size(); ++i) way_[i] = x[i] - p.predicted[i];
    assembly_.mass_times(way_, inertia_);
    for (std::size_t i = 0; i < r_.size(); ++i) {
      const Vec3 f = p.mass_scale * inertia_[i];
      inertia_energy_ += 0.5 * dot(f, way_[i]);
      r_[i] += f;
      magnitude_[i] += norm(f);
    }
  }
  assembly_.prescribed_row_values(prescribed_phi_);
}

// Of the last evaluation: theta = phi - target - C lambda.
void SaddlePoint::row_residual(const SaddleProblem& p, std::span<const double> lambda) {
  const System& s = *system_;
  assembly_.row_values(theta_);
  for (std::size_t r = 0; r < theta_.size(); ++r) theta_[r] -= p.target[r];
  add_compliance(s, -1, lambda, theta_);
  if (s.laws().empty()) return;
  law_energy_ = apply_laws(p, lambda, false);
  for (const auto& law : s.laws()) {
    const auto first = s.first_row(law.row_pool), rows = s.parts().row_pools[at(law.row_pool)]->rows();
    for (Index r = first; r < first + rows; ++r) theta_[at(r)] -= strain_[at(r)];
  }
}

SaddlePoint::RowResiduals SaddlePoint::measure_rows(const SaddleProblem& p, std::span<const Vec3> x,
                                                    std::span<const double> lambda) const {
  const System& s = *system_;
  double row = 0, position = 0;
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
  return {row, s.length() > 0 ? position / s.length() : position};
}

SaddlePoint::Residuals SaddlePoint::measure(const SaddleProblem& p, std::span<const Vec3> x,
                                            std::span<const double> lambda) const {
  const System& s = *system_;
  double force = 0, reference = 0;
  // Far from the origin, coordinates have fewer digits to tell a deformation by.
  double farthest = 0;
  for (const Vec3& at_node : x) farthest = std::max(farthest, dot(at_node, at_node));
  const double floor = 1e-6 * std::max(s.length(), std::sqrt(farthest));
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
  const double relative = reference > 0 ? std::sqrt(force / reference) : 0;
  const RowResiduals rows = measure_rows(p, x, lambda);
  return {relative, rows.row, rows.position};
}

// Writes the residuals of the last evaluation into the report and says whether they are within tolerance.
bool SaddlePoint::balanced(const SaddleProblem& p, const SaddleOptions& o, std::span<const Vec3> x,
                           std::span<const double> lambda, SaddleReport& report) const {
  const Residuals r = measure(p, x, lambda);
  report.force_residual = r.force;
  report.row_residual = r.row;
  return r.force <= o.force_tolerance && r.row <= o.row_tolerance && r.position <= o.position_tolerance;
}

SaddlePoint::Stored SaddlePoint::stored(const SaddleProblem& p, std::span<const Vec3> x,
                                        std::span<const double> lambda) const {
  constexpr double rows_met = 1e-8, positions_met = 1e-11;
  Stored s;
  const double compliance = compliance_energy(*system_, lambda);
  s.energy = potential(p, x) - inertia_energy_ + compliance;
  if (!system_->laws().empty()) s.energy += law_energy_;
  s.elastic = assembly_.absolute_energy() + compliance;
  s.noise = 1e-12 * potential_magnitude(p, x);
  const RowResiduals rows = measure_rows(p, x, lambda);
  s.row = rows.row;
  s.met = rows.row <= rows_met && rows.position <= positions_met;
  return s;
}

SaddlePoint::Stored SaddlePoint::stored_at(const SaddleProblem& p, std::span<const Vec3> x,
                                           std::span<const double> lambda) {
  assembly_.evaluate(Want::value, Definiteness::exact, x, lambda, p.prescribed);
  assembly_.prescribed_row_values(prescribed_phi_);
  row_residual(p, lambda);
  inertia_energy_ = 0;
  return stored(p, x, lambda);
}

void SaddlePoint::add_inertia_of_gap(std::span<Vec3> y) {
  if (system_->block_mass().empty() || mass_scale_ == 0) return;
  assembly_.mass_times(gap_, inertia_);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] += mass_scale_ * inertia_[i];
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

// Assembles and factors; mends a wrong inertia by a shift of the displacement block, small at first, and when
// that grows out of proportion by the stencils' projected Hessians. Gives up at once where the matrix is
// singular whatever the shift: then it is the rows that depend on each other.
bool SaddlePoint::factor(const SaddleProblem& p, std::span<const Vec3> x, std::span<const double> lambda,
                         SaddleReport& report) {
  mended_ = false;
  if (factor_shifted(p.mass_scale, 0, report)) return true;
  if (gave_up(report)) return false;
  mended_ = true;
  if (system_->has_bounds() && singular_ && add_trace(p.mass_scale, report)) return true;
  if (gave_up(report)) return false;
  ++report.shifted;
  // Starting from a third of what the last wrong inertia took finds the size in one or two trials.
  double shift = shift_ > 0 ? std::max(smallest_shift, shift_ / 3) : 1e-3;
  constexpr int most_singular = 2;
  int singular = singular_ ? 1 : 0;
  for (; shift < 1; shift *= 6) {
    if (factor_shifted(p.mass_scale, shift, report)) {
      shift_ = shift;
      return true;
    }
    singular = singular_ ? singular + 1 : 0;
    if (gave_up(report)) return false;
    if (singular > most_singular) {
      report.status = SaddleStatus::singular;
      explain_singular(report);
      return false;
    }
  }
  {
    const Stopwatch watch(seconds_.evaluate);
    assembly_.evaluate(Want::hessian, std::max(definiteness_, Definiteness::projected), x, lambda,
                       p.prescribed);
  }
  ++report.projected;
  for (shift = 0; shift < 1e3; shift = std::max(1e-3, 30 * shift)) {
    if (factor_shifted(p.mass_scale, shift, report)) return true;
    if (gave_up(report)) return false;
  }
  report.status = SaddleStatus::singular;
  explain_singular(report);
  return false;
}

// Several bounded rows may ask the same of the same nodes (two obstacles side by side, a flat cell all of
// whose nodes touch): then their multipliers are not unique, and a trace of compliance in the matrix picks
// some. It slows the iteration by as little, and is as large as it has to be.
bool SaddlePoint::add_trace(double mass_scale, SaddleReport& report) {
  constexpr double smallest = 1e-8, largest = 1e-2;
  while (singular_ && trace_ < largest) {
    trace_ = trace_ == 0 ? smallest : 100 * trace_;
    if (factor_shifted(mass_scale, 0, report)) return true;
    if (gave_up(report)) return false;
  }
  return false;
}

// Inverse iteration on the matrix with a little of everything on its diagonal: the vector that it maps to
// next to nothing tells what is wrong with a matrix that no shift mends.
void SaddlePoint::explain_singular(SaddleReport& report) {
  constexpr double regularization = 1e-4;
  constexpr int iterations = 4;
  if (system_->kkt().size == 0) return;
  const double trace = trace_;
  trace_ = regularization;
  SaddleReport unused;
  factor_shifted(mass_scale_, regularization, unused);
  trace_ = trace;
  const auto size = at(system_->kkt().size);
  std::vector<double> right(size), null(size);
  for (std::size_t i = 0; i < size; ++i) right[i] = 1 + 0.3 * std::sin(static_cast<double>(i));
  for (int k = 0; k < iterations; ++k) {
    if (interrupted() || !kkt_.linear_solver().solve(right, null).ok) return;
    double square = 0;
    for (const double v : null) square += v * v;
    if (!(square > 0) || !std::isfinite(square)) return;
    for (std::size_t i = 0; i < size; ++i) right[i] = null[i] / std::sqrt(square);
  }
  double rows = 0;
  for (std::size_t i = at(system_->free_unknowns()); i < size; ++i) rows += right[i] * right[i];
  if (rows > 0.5) name_rows(right, report);
  if (rows <= 0.5) name_nodes(right, report);
}

// The effects whose rows have a share in a null vector, and the nodes of the row that has most.
void SaddlePoint::name_rows(std::span<const double> null, SaddleReport& report) const {
  const System& s = *system_;
  const auto first_row = at(s.free_unknowns());
  double largest = 0;
  Index worst = -1;
  for (std::size_t k = 0; k < s.kept_rows().size(); ++k) {
    if (std::abs(null[first_row + k]) <= largest) continue;
    largest = std::abs(null[first_row + k]);
    worst = s.kept_rows()[k];
  }
  for (std::size_t p = 0; p < s.parts().row_pools.size(); ++p) {
    const RowPool& pool = *s.parts().row_pools[p];
    if (pool.law != RowLaw::compliant) continue;
    const Index first = s.first_row(static_cast<Index>(p));
    for (std::size_t k = 0; k < s.kept_rows().size(); ++k) {
      const Index r = s.kept_rows()[k] - first;
      if (r < 0 || r >= pool.rows() || std::abs(null[first_row + k]) < 0.1 * largest) continue;
      report.null_rows.emplace_back(pool.name());
      break;
    }
  }
  constexpr std::size_t enough = 8;
  for (const auto& [row, node] : s.jacobian_ends()) {
    if (row == worst && report.null_nodes.size() < enough) report.null_nodes.push_back(node);
  }
}

void SaddlePoint::name_nodes(std::span<const double> null, SaddleReport& report) const {
  const auto first = system_->first_unknown();
  std::vector<std::pair<double, Index>> moves;
  for (Index i = 0; i < system_->nodes(); ++i) {
    double square = 0;
    for (Index c = first[at(i)]; c < first[at(i) + 1]; ++c) square += null[at(c)] * null[at(c)];
    moves.emplace_back(-square, i);
  }
  constexpr std::size_t enough = 8;
  const auto count = std::min(enough, moves.size());
  std::partial_sort(moves.begin(), moves.begin() + static_cast<std::ptrdiff_t>(count), moves.end());
  for (std::size_t k = 0; k < count && moves[k].first <= 0.1 * moves[0].first && moves[0].first < 0; ++k)
    report.null_nodes.push_back(moves[k].second);
}

// Whether no other matrix is to be tried.
bool SaddlePoint::gave_up(SaddleReport& report) const {
  if (interrupted()) report.status = SaddleStatus::cancelled;
  return report.status == SaddleStatus::out_of_memory || report.status == SaddleStatus::cancelled;
}

bool SaddlePoint::factor_shifted(double mass_scale, double shift, SaddleReport& report) {
  Kkt::Values values;
  values.mass_scale = mass_scale;
  values.shift = shift;
  values.stiffness = stiffness_;
  values.tangent = tangent_;
  if (any_clamped_) values.clamped = clamped_;
  values.trace = trace_;
  const Kkt::Outcome f = kkt_.factor(assembly_, values, seconds_);
  singular_ = f.status == FactorStatus::singular;
  ++report.factorizations;
  report.negative_pivots = f.negative;
  if (f.status == FactorStatus::out_of_memory) report.status = SaddleStatus::out_of_memory;
  if (f.status != FactorStatus::ok) {
    report.message = f.message;
    return false;
  }
  return f.negative < 0 || f.negative == system_->rows();
}

}  // namespace isochor
