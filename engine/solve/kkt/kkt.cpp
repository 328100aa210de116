#include "engine/solve/kkt/kkt.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <chrono>
#include <cmath>

namespace isochor {

namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Stopwatch::Stopwatch(double& total) : total_(total), start_(now()) {}
Stopwatch::~Stopwatch() {
  total_ += now() - start_;
}

Kkt::Kkt(std::shared_ptr<const System> system, const Parallel& parallel, std::unique_ptr<LinearSolver> solver)
    : system_(std::move(system)), parallel_(parallel), solver_(std::move(solver)), factored_(solver_.get()) {
  const System& s = *system_;
  const std::size_t size = at(s.kkt().size), border = s.bordered_rows().size();
  values_.resize(static_cast<std::size_t>(s.kkt().nonzeros()));
  scale_.resize(size);
  rhs_.resize(size);
  solution_.resize(size);
  solver_->set_parallel(parallel_);
  if (solver_->wants_geometry()) describe_unknowns();
  const bool dual = !s.dual_rows().empty();
  if (!s.condensed_rows().empty() || border > 0 || dual) row_jacobian_.resize(s.jacobian_ends().size());
  condensed_compliance_.resize(s.condensed_rows().size());
  condensed_part_.resize(s.condensed_rows().size());
  border_solution_.resize(size * border);
  schur_.resize(border * border);
  schur_vectors_.resize(border * border);
  border_value_.resize(border);
  border_work_.resize(border);
  border_rhs_.resize(border);
  border_kept_.resize(border);
  if (!dual) return;
  for (auto* v :
       {&weight_, &preconditioner_, &active_, &cg_x_, &cg_r_, &cg_z_, &cg_p_, &cg_q_, &cg_work_, &cg_rhs_}) {
    v->assign(at(s.rows()), 0);
  }
  dual_value_.resize(s.dual_compliance().size());
  matrix_rhs_.resize(size);
}

void Kkt::describe_unknowns() {
  const System& s = *system_;
  std::vector<UnknownGeometry> geometry;
  geometry.reserve(at(s.free_unknowns()));
  for (Index i = 0; i < s.nodes(); ++i) {
    const Index b = s.basis_of()[at(i)];
    for (int c = 0; c < s.first_unknown()[at(i) + 1] - s.first_unknown()[at(i)]; ++c) {
      Vec3 direction{};
      direction[c] = 1;
      if (b >= 0) direction = s.free_bases()[at(b)].directions * direction;
      geometry.push_back({i, s.parts().rest[at(i)], direction});
    }
  }
  solver_->set_geometry(std::move(geometry));
}

double Kkt::compliance_of(const Values& values, std::size_t entry) const {
  const double constant = system_->compliance()[entry].value;
  for (const auto& law : system_->laws()) {
    const std::size_t count = system_->parts().row_pools[at(law.row_pool)]->compliance.size();
    if (entry >= law.first_entry && entry < law.first_entry + count) return values.tangent[entry];
  }
  return constant;
}

// Unknowns are scaled to a unit diagonal: nodes by their stiffness, rows by their metric. The shift comes
// with it, relative to the stiffness before rows are condensed into it.
void Kkt::scale_unknowns(const Values& values) {
  const System& s = *system_;
  const auto first = s.first_unknown();
  for (Index i = 0; i < s.nodes(); ++i) {
    double k = 0;
    for (Index c = first[at(i)]; c < first[at(i) + 1]; ++c) {
      k = std::max(k, std::abs(values_[static_cast<std::size_t>(s.diagonal_place()[at(c)])]));
    }
    const double reference = std::max(k, 0.01 * values.stiffness[at(i)]);
    for (Index c = first[at(i)]; c < first[at(i) + 1]; ++c) {
      scale_[at(c)] = reference > 0 ? 1 / std::sqrt(reference) : 1;
      values_[static_cast<std::size_t>(s.diagonal_place()[at(c)])] += values.shift * reference;
    }
  }
  for (Index r = 0; r < s.rows(); ++r) {
    const Index u = s.row_unknown()[at(r)];
    if (u >= 0) scale_[at(u)] = 1 / std::sqrt(s.row_metric()[at(r)]);
  }
  if (!s.filled_rows().empty()) {
    add_filled(values);
    for (Index c = 0; c < s.free_unknowns(); ++c) {
      const double d = std::abs(values_[static_cast<std::size_t>(s.diagonal_place()[at(c)])]);
      scale_[at(c)] = std::min(scale_[at(c)], d > 0 ? 1 / std::sqrt(d) : 1);
    }
  }
}

// K += G_r^T G_r / C_r for every condensed row that is not held at a bound and G_r^T W_r G_r for every
// augmented one, in the order of the rows.
void Kkt::add_filled(const Values& values) {
  const System& s = *system_;
  const auto first = s.first_unknown();
  std::size_t place = 0;
  for (std::size_t k = 0; k < s.filled_rows().size(); ++k) {
    const Index row = s.filled_rows()[k];
    const bool condensed = k < s.condensed_rows().size();
    const bool held = condensed && !values.clamped.empty() && values.clamped[at(row)] != 0;
    double weight =
        condensed ? 1 / compliance_of(values, s.diagonal_compliance()[at(row)]) : weight_[at(row)];
    if (condensed) condensed_compliance_[k] = held ? kHeld : 1 / weight;
    if (condensed && gmres_) free_compliance_[k] = 1 / weight;
    if (held) weight = 0;
    const auto begin = s.row_jacobian_begin()[at(row)], end = s.row_jacobian_begin()[at(row) + 1];
    for (std::size_t a = begin; a < end; ++a) {
      const Index i = s.jacobian_ends()[a][1], ki = first[at(i) + 1] - first[at(i)];
      for (std::size_t b = begin; b <= a; ++b) {
        const Index j = s.jacobian_ends()[b][1], kj = first[at(j) + 1] - first[at(j)];
        for (Index q = 0; q < kj; ++q, ++place) {
          if (ki == 0) continue;
          auto to = static_cast<std::size_t>(s.filled_place()[place]);
          const double factor = row_jacobian_[b][q] * weight;
          for (Index p = i == j ? q : 0; p < ki; ++p) values_[to++] += row_jacobian_[a][p] * factor;
        }
      }
    }
  }
}

// A trace of compliance for the kept rows, relative to what they do in the scaled matrix: the squares of
// their entries over a unit diagonal.
void Kkt::add_trace(double trace) {
  const System& s = *system_;
  const SymmetricPattern& kkt = s.kkt();
  std::fill(rhs_.begin(), rhs_.end(), 0.0);
  for (Index c = 0; c < s.free_unknowns(); ++c) {
    const auto to = static_cast<std::size_t>(kkt.column_start[at(c) + 1]);
    for (auto k = static_cast<std::size_t>(kkt.column_start[at(c)]); k < to; ++k) {
      if (kkt.row[k] >= s.free_unknowns()) rhs_[at(kkt.row[k])] += values_[k] * values_[k];
    }
  }
  for (Index u = s.free_unknowns(); u < kkt.size; ++u) {
    values_[static_cast<std::size_t>(s.diagonal_place()[at(u)])] -= trace * rhs_[at(u)];
  }
}

// Column of a bordered row, in scaled unknowns.
void Kkt::border_column(Index row, std::span<double> column) const {
  const System& s = *system_;
  const auto first = s.first_unknown();
  std::fill(column.begin(), column.end(), 0.0);
  for (auto d = s.row_jacobian_begin()[at(row)]; d < s.row_jacobian_begin()[at(row) + 1]; ++d) {
    const Index i = s.jacobian_ends()[d][1];
    for (Index c = first[at(i)]; c < first[at(i) + 1]; ++c) {
      column[at(c)] = scale_[at(c)] * row_jacobian_[d][c - first[at(i)]];
    }
  }
}

double Kkt::row_dot(Index row, std::span<const double> v) const {
  const System& s = *system_;
  const auto first = s.first_unknown();
  double sum = 0;
  for (auto d = s.row_jacobian_begin()[at(row)]; d < s.row_jacobian_begin()[at(row) + 1]; ++d) {
    const Index i = s.jacobian_ends()[d][1];
    for (Index c = first[at(i)]; c < first[at(i) + 1]; ++c) {
      sum += scale_[at(c)] * row_jacobian_[d][c - first[at(i)]] * v[at(c)];
    }
  }
  return sum;
}

// w += G_r^T multiplier.
void Kkt::add_row_force(Index row, double multiplier, std::span<double> w) const {
  const System& s = *system_;
  const auto first = s.first_unknown();
  for (auto d = s.row_jacobian_begin()[at(row)]; d < s.row_jacobian_begin()[at(row) + 1]; ++d) {
    const Index i = s.jacobian_ends()[d][1];
    for (Index c = first[at(i)]; c < first[at(i) + 1]; ++c) {
      w[at(c)] += scale_[at(c)] * row_jacobian_[d][c - first[at(i)]] * multiplier;
    }
  }
}

// With the matrix A = L D L^T at hand: S = -C_b - B^T A^-1 B, its eigenvectors (it is small and indefinite),
// and its share of the inertia (Haynsworth: that of the whole is that of A plus that of S).
Kkt::Outcome Kkt::eliminate_border(const Values& values, Outcome outcome) {
  const System& s = *system_;
  const std::size_t nb = s.bordered_rows().size(), size = at(s.kkt().size);
  Eigen::Map<Eigen::MatrixXd> schur(schur_.data(), static_cast<Eigen::Index>(nb),
                                    static_cast<Eigen::Index>(nb));
  schur.setZero();
  for (std::size_t k = 0; k < nb; ++k) {
    if (interrupted()) {
      outcome.status = FactorStatus::interrupted;
      return outcome;
    }
    const auto z = std::span(border_solution_).subspan(k * size, size);
    border_column(s.bordered_rows()[k], rhs_);
    const SolveReport solved = solver_->solve(rhs_, z);
    inertia_was_wrong_ = inertia_was_wrong_ || solved.inertia_changed;
    if (!solved.ok) {
      outcome.status = FactorStatus::singular;
      outcome.message = "the system without its bordered rows is singular";
      return outcome;
    }
    for (std::size_t j = 0; j < nb; ++j) {
      schur(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(k)) -= row_dot(s.bordered_rows()[j], z);
    }
  }
  for (const auto& [entry, row, col] : s.border_compliance()) {
    const double c = compliance_of(values, entry);
    schur(row, col) -= c;
    if (row != col) schur(col, row) -= c;
  }
  // Rows in units of their metric, so that small eigenvalues mean dependence and not units.
  for (std::size_t j = 0; j < nb; ++j)
    border_work_[j] = 1 / std::sqrt(s.row_metric()[at(s.bordered_rows()[j])]);
  for (Eigen::Index j = 0; j < schur.rows(); ++j) {
    for (Eigen::Index k = 0; k < schur.rows(); ++k) {
      schur(j, k) *= border_work_[static_cast<std::size_t>(j)] * border_work_[static_cast<std::size_t>(k)];
    }
  }
  const Eigen::MatrixXd symmetric = 0.5 * (schur + schur.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(symmetric);
  const double largest = eigen.eigenvalues().cwiseAbs().maxCoeff();
  if (!std::isfinite(largest) || eigen.eigenvalues().cwiseAbs().minCoeff() <= 1e-14 * largest) {
    outcome.status = FactorStatus::singular;
    outcome.message = "the bordered rows depend on each other";
    return outcome;
  }
  if (outcome.negative >= 0)
    outcome.negative += static_cast<Index>((eigen.eigenvalues().array() < 0).count());
  Eigen::Map<Eigen::MatrixXd> inverse(schur_vectors_.data(), schur.rows(), schur.rows());
  inverse = eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() *
            eigen.eigenvectors().transpose();
  for (Eigen::Index j = 0; j < schur.rows(); ++j) {
    for (Eigen::Index k = 0; k < schur.rows(); ++k) {
      inverse(j, k) *= border_work_[static_cast<std::size_t>(j)] * border_work_[static_cast<std::size_t>(k)];
    }
  }
  return outcome;
}

Kkt::Outcome Kkt::factor(const Assembly& assembly, const Values& values, StageSeconds& seconds) {
  const System& s = *system_;
  const SymmetricPattern& kkt = s.kkt();
  {
    const Stopwatch watch(seconds.gather);
    // Places that only filled rows write to have no other owner.
    if (!s.filled_rows().empty()) std::fill(values_.begin(), values_.end(), 0.0);
    assembly.kkt_values(values.mass_scale, values_);
    if (!row_jacobian_.empty()) assembly.row_jacobian(row_jacobian_);
    for (const auto& [index, entry] : s.laws()) {
      const std::size_t entries = s.parts().row_pools[at(index)]->compliance.size();
      for (std::size_t k = entry; k < entry + entries; ++k) {
        const auto place = s.compliance_place()[k];
        if (place >= 0) values_[static_cast<std::size_t>(place)] -= values.tangent[k];
      }
    }
    if (!factored_held_.empty()) {
      if (values.clamped.empty())
        std::fill(factored_held_.begin(), factored_held_.end(), std::uint8_t{0});
      else
        std::copy(values.clamped.begin(), values.clamped.end(), factored_held_.begin());
    }
    if (!values.clamped.empty()) {
      // A row held at a bound leaves the system, with a diagonal that keeps the inertia.
      const auto held = [&](Index i) {
        const Index row = i >= s.free_unknowns() ? s.kept_rows()[at(i - s.free_unknowns())] : -1;
        return row >= 0 && values.clamped[at(row)] ? row : -1;
      };
      for (Index c = 0; c < kkt.size; ++c) {
        const auto to = static_cast<std::size_t>(kkt.column_start[at(c) + 1]);
        const bool column_held = held(c) >= 0;
        for (auto k = static_cast<std::size_t>(kkt.column_start[at(c)]); k < to; ++k) {
          const Index row = held(kkt.row[k]);
          if (row < 0 && !column_held) continue;
          values_[k] = kkt.row[k] == c ? -s.row_metric()[at(row)] : 0;
        }
      }
    }
    if (!s.dual_rows().empty()) prepare_dual(values);
    scale_unknowns(values);
    parallel_.run(kkt.size, 1024, [&](Index b, Index e) {
      for (Index c = b; c < e; ++c) {
        const auto to = static_cast<std::size_t>(kkt.column_start[at(c) + 1]);
        for (auto k = static_cast<std::size_t>(kkt.column_start[at(c)]); k < to; ++k) {
          values_[k] *= scale_[at(c)] * scale_[at(kkt.row[k])];
        }
      }
    });
    if (values.trace > 0) add_trace(values.trace);
  }
  if (values.unsymmetric) {
    {
      const Stopwatch watch(seconds.gather);
      const auto lower = std::span(both_triangles_).first(values_.size());
      const auto upper = std::span(both_triangles_).subspan(values_.size());
      std::copy(values_.begin(), values_.end(), lower.begin());
      std::copy(values_.begin(), values_.end(), upper.begin());
      for (const std::int64_t k : s.diagonal_place()) upper[static_cast<std::size_t>(k)] = 0;
      values.unsymmetric->add_to(scale_, values.clamped, lower, upper);
    }
    inertia_was_wrong_ = false;
    return factor_values(*unsymmetric_solver_, unsymmetric_analyzed_, both_triangles_, seconds);
  }
  const Outcome outcome = factor_scaled(values, seconds);
  return inertia_was_wrong_ ? factor_scaled(values, seconds) : outcome;
}

Kkt::Outcome Kkt::factor_scaled(const Values& values, StageSeconds& seconds) {
  const System& s = *system_;
  inertia_was_wrong_ = false;
  Outcome outcome = factor_values(*solver_, analyzed_, values_, seconds);
  if (outcome.status != FactorStatus::ok) return outcome;
  // A condensed row has its negative pivot in -C, eliminated first; a dual one in its Schur complement, whose
  // sign is right whenever that of the (augmented) stiffness is.
  if (outcome.negative >= 0)
    outcome.negative += static_cast<Index>(s.condensed_rows().size() + s.dual_rows().size());
  return s.bordered_rows().empty() ? outcome : eliminate_border(values, outcome);
}

void Kkt::set_interrupt(const std::function<bool()>& asked) {
  interrupt_ = asked;
  solver_->set_interrupt(asked);
  if (unsymmetric_solver_) unsymmetric_solver_->set_interrupt(asked);
}

void Kkt::take_unsymmetric(std::unique_ptr<LinearSolver> solver) {
  unsymmetric_solver_ = std::move(solver);
  both_triangles_.resize(2 * values_.size());
}

// Scaled values of one or both triangles; analyzes before the first.
Kkt::Outcome Kkt::factor_values(LinearSolver& solver, bool& analyzed, std::span<const double> values,
                                StageSeconds& seconds) {
  Outcome outcome;
  if (!analyzed) {
    const Stopwatch watch(seconds.analyze);
    const FactorReport f = solver.analyze(system_->kkt());
    ++analyses_;
    outcome.status = f.status;
    outcome.message = f.message;
    if (f.status != FactorStatus::ok) return outcome;
    analyzed = true;
  }
  const Stopwatch watch(seconds.factor);
  solver.set_scale(scale_);
  const FactorReport f = solver.factor(values);
  factored_ = &solver;
  factor_nonzeros_ = f.factor_nonzeros;
  return {f.status, f.negative_pivots, f.message};
}

// The matrix A with its border, from rhs_ and border_rhs_ to solution_ and border_value_.
bool Kkt::solve_matrix(StageSeconds& seconds) {
  const System& s = *system_;
  const Stopwatch watch(seconds.solve);
  const SolveReport solved = factored_->solve(rhs_, solution_);
  residual_ = std::max(residual_, solved.residual);
  linear_iterations_ += solved.iterations;
  inertia_was_wrong_ = inertia_was_wrong_ || solved.inertia_changed;
  const std::size_t nb = s.bordered_rows().size(), size = at(s.kkt().size);
  if (nb == 0) return solved.ok;
  // dlambda_b = S^-1 (g_b - B^T A^-1 f), u = A^-1 f - A^-1 B dlambda_b.
  for (std::size_t j = 0; j < nb; ++j)
    border_work_[j] = border_rhs_[j] - row_dot(s.bordered_rows()[j], solution_);
  for (std::size_t j = 0; j < nb; ++j) {
    double sum = 0;
    for (std::size_t k = 0; k < nb; ++k) sum += schur_vectors_[k * nb + j] * border_work_[k];
    border_value_[j] = sum;
  }
  for (std::size_t j = 0; j < nb; ++j) {
    const double* const z = border_solution_.data() + j * size;
    for (std::size_t i = 0; i < size; ++i) solution_[i] -= z[i] * border_value_[j];
  }
  return solved.ok;
}

// Forces of all nodes into the displacement part of rhs_, in free directions and scaled.
void Kkt::to_unknowns(std::span<const Vec3> node_rhs) {
  const System& s = *system_;
  const auto first = s.first_unknown();
  for (Index i = 0; i < s.nodes(); ++i) {
    Vec3 q = node_rhs[at(i)];
    const Index b = s.basis_of()[at(i)];
    if (b >= 0) q = transposed_times(s.free_bases()[at(b)].directions, q);
    for (Index c = first[at(i)]; c < first[at(i) + 1]; ++c) rhs_[at(c)] = scale_[at(c)] * q[c - first[at(i)]];
  }
}

// The displacement part of scaled unknowns as steps of all nodes.
void Kkt::to_nodes(std::span<const double> u, std::span<Vec3> dx) const {
  const System& s = *system_;
  const auto first = s.first_unknown();
  for (Index i = 0; i < s.nodes(); ++i) {
    Vec3 q{};
    for (Index c = first[at(i)]; c < first[at(i) + 1]; ++c) q[c - first[at(i)]] = scale_[at(c)] * u[at(c)];
    const Index b = s.basis_of()[at(i)];
    dx[at(i)] = b >= 0 ? s.free_bases()[at(b)].directions * q : q;
  }
}

// Right-hand sides of the matrix and its border.
void Kkt::begin_solve(std::span<const Vec3> node_rhs, std::span<const double> row_rhs) {
  const System& s = *system_;
  const auto condensed = s.condensed_rows(), bordered = s.bordered_rows();
  to_unknowns(node_rhs);
  for (Index r = 0; r < s.rows(); ++r) {
    const Index u = s.row_unknown()[at(r)];
    if (u >= 0) rhs_[at(u)] = scale_[at(u)] * row_rhs[at(r)];
  }
  residual_ = 0;
  // G dx - C dlambda = g: dlambda = (G dx - g) / C, so G^T g / C joins the right-hand side of the nodes.
  for (std::size_t k = 0; k < condensed.size(); ++k) {
    // Of a row held at a bound -D dlambda = g is left, as in the matrix.
    if (condensed_compliance_[k] == kHeld) continue;
    condensed_part_[k] = row_rhs[at(condensed[k])] / condensed_compliance_[k];
    add_row_force(condensed[k], condensed_part_[k], rhs_);
  }
  for (std::size_t j = 0; j < bordered.size(); ++j) border_rhs_[j] = row_rhs[at(bordered[j])];
}

// From the unknowns of the matrix and its border to steps.
void Kkt::end_solve(std::span<const double> row_rhs, std::span<Vec3> dx, std::span<double> dlambda) {
  const System& s = *system_;
  const auto condensed = s.condensed_rows(), bordered = s.bordered_rows();
  for (std::size_t j = 0; j < bordered.size(); ++j) dlambda[at(bordered[j])] = border_value_[j];
  for (const Index r : s.dual_rows()) dlambda[at(r)] = cg_x_[at(r)];
  for (std::size_t k = 0; k < condensed.size(); ++k) {
    if (condensed_compliance_[k] == kHeld) {
      dlambda[at(condensed[k])] = -row_rhs[at(condensed[k])] / s.row_metric()[at(condensed[k])];
      continue;
    }
    const double sum = row_dot(condensed[k], solution_);
    dlambda[at(condensed[k])] = sum / condensed_compliance_[k] - condensed_part_[k];
  }
  to_nodes(solution_, dx);
  for (Index r = 0; r < s.rows(); ++r) {
    const Index u = s.row_unknown()[at(r)];
    if (u >= 0) dlambda[at(r)] = scale_[at(u)] * solution_[at(u)];
  }
}

bool Kkt::solve(std::span<const Vec3> node_rhs, std::span<const double> row_rhs, std::span<Vec3> dx,
                std::span<double> dlambda, StageSeconds& seconds) {
  begin_solve(node_rhs, row_rhs);
  const bool ok = system_->dual_rows().empty() ? solve_matrix(seconds) : solve_dual(row_rhs, seconds);
  end_solve(row_rhs, dx, dlambda);
  return ok;
}

}  // namespace isochor
