// Systems next to the one that was factored, by a generalized minimal residual method that its factors
// precondition. Matrices differ by what happens at a surface (friction that follows the normal force, points
// that begin or cease to touch), so that few steps do, each a pair of triangular solves and a product with
// the matrix.
#include <algorithm>
#include <cmath>

#include "engine/solve/kkt/kkt.h"

namespace isochor {

namespace {

constexpr int most_directions = 20;

}  // namespace

void Kkt::prepare_coupled() {
  const System& s = *system_;
  gmres_.emplace(at(s.kkt().size), most_directions);
  condensed_index_.assign(at(s.rows()), -1);
  for (std::size_t k = 0; k < s.condensed_rows().size(); ++k)
    condensed_index_[at(s.condensed_rows()[k])] = static_cast<Index>(k);
  if (s.has_bounds()) {
    factored_held_.assign(at(s.rows()), 0);
    movable_.assign(at(s.rows()), 1);
    own_compliance_.assign(at(s.rows()), 0);
    for (const ComplianceEntry& e : s.compliance()) {
      if (e.row != e.col) movable_[at(e.row)] = movable_[at(e.col)] = 0;
      if (e.row == e.col) own_compliance_[at(e.row)] += e.value;
    }
    for (const auto& law : s.laws()) {
      const auto first = movable_.begin() + s.first_row(law.row_pool);
      std::fill(first, first + s.parts().row_pools[at(law.row_pool)]->rows(), std::uint8_t{0});
    }
    row_jacobian_.resize(s.jacobian_ends().size());
  }
  free_compliance_.assign(s.condensed_rows().size(), 0);
  changed_.reserve(at(s.rows()));
  coupled_dx_.resize(at(s.nodes()));
  coupled_force_.resize(at(s.nodes()));
  coupled_dlambda_.assign(at(s.rows()), 0);
}

// w = A u, from the lower triangle.
void Kkt::matrix_times(std::span<const double> u, std::span<double> w) const {
  const SymmetricPattern& kkt = system_->kkt();
  const double* const v = values_.data();
  const Index* const row = kkt.row.data();
  std::fill(w.begin(), w.end(), 0.0);
  for (Index c = 0; c < kkt.size; ++c) {
    const double uc = u[at(c)];
    double sum = 0;
    for (auto k = kkt.column_start[at(c)]; k < kkt.column_start[at(c) + 1]; ++k) {
      const Index i = row[k];
      sum += v[k] * u[at(i)];
      if (i != c) w[at(i)] += v[k] * uc;
    }
    w[at(c)] += sum;
  }
}

// Forces of nodes on scaled unknowns.
void Kkt::add_scaled_forces(double factor, std::span<const Vec3> force, std::span<double> w) const {
  const System& s = *system_;
  const auto first = s.first_unknown();
  for (Index i = 0; i < s.nodes(); ++i) {
    if (force[at(i)] == Vec3{}) continue;
    Vec3 q = force[at(i)];
    const Index b = s.basis_of()[at(i)];
    if (b >= 0) q = transposed_times(s.free_bases()[at(b)].directions, q);
    for (Index c = first[at(i)]; c < first[at(i) + 1]; ++c)
      w[at(c)] += factor * scale_[at(c)] * q[c - first[at(i)]];
  }
}

// Rows as they are held now; false when one changes whose compliance ties it to others.
bool Kkt::take_held(std::span<const std::uint8_t> clamped) {
  changed_.clear();
  for (std::size_t r = 0; r < factored_held_.size(); ++r) {
    const bool held = !clamped.empty() && clamped[r] != 0;
    const Index k = condensed_index_[r];
    if (k >= 0 && held != (condensed_compliance_[at(k)] == kHeld))
      condensed_compliance_[at(k)] = held ? kHeld : free_compliance_[at(k)];
    if (held == (factored_held_[r] != 0)) continue;
    if (k < 0 && movable_[r] == 0) return false;
    changed_.push_back(static_cast<Index>(r));
  }
  return true;
}

bool Kkt::holds(std::span<const std::uint8_t> clamped) const {
  for (std::size_t r = 0; r < factored_held_.size(); ++r) {
    if ((factored_held_[r] != 0) != (!clamped.empty() && clamped[r] != 0)) return false;
  }
  return true;
}

// w = (A + L) u, A with the rows that are held now; multipliers of condensed rows follow the steps of the
// nodes, those held at a bound have their step on the right-hand side.
void Kkt::coupled_times(const UnsymmetricPart* part, std::span<const std::uint8_t> clamped,
                        std::span<const double> u, std::span<double> w) {
  const System& s = *system_;
  matrix_times(u, w);
  for (const Index r : changed_) {
    const bool released = factored_held_[at(r)] != 0;
    const double sign = released ? 1 : -1;
    const Index k = condensed_index_[at(r)];
    if (k >= 0) {
      add_row_force(r, sign * row_dot(r, u) / free_compliance_[at(k)], w);
      continue;
    }
    // A row that is an unknown: its entries, and the diagonal in place of them while it is held.
    const Index unknown = s.row_unknown()[at(r)];
    const double scale = scale_[at(unknown)], step = u[at(unknown)];
    add_row_force(r, sign * scale * step, w);
    w[at(unknown)] = released ? scale * (row_dot(r, u) - own_compliance_[at(r)] * scale * step)
                              : -s.row_metric()[at(r)] * scale * scale * step;
  }
  if (part == nullptr) return;
  to_nodes(u, coupled_dx_);
  for (const Index r : part->rows()) {
    double& step = coupled_dlambda_[at(r)] = 0;
    if (!clamped.empty() && clamped[at(r)]) continue;
    const Index unknown = s.row_unknown()[at(r)], k = condensed_index_[at(r)];
    if (unknown >= 0)
      step = scale_[at(unknown)] * u[at(unknown)];
    else if (k >= 0)
      step = row_dot(r, u) / condensed_compliance_[at(k)];
  }
  std::fill(coupled_force_.begin(), coupled_force_.end(), Vec3{});
  part->add_times(coupled_dx_, coupled_dlambda_, coupled_force_);
  add_scaled_forces(1, coupled_force_, w);
}

// Takes what a condensed row's multiplier does to forces apart from the steps to the right-hand side.
void Kkt::move_constant_part(const UnsymmetricPart& part) {
  bool any = false;
  for (const Index r : part.rows()) {
    const Index k = condensed_index_[at(r)];
    const bool free = k >= 0 && condensed_compliance_[at(k)] != kHeld;
    coupled_dlambda_[at(r)] = free ? -condensed_part_[at(k)] : 0;
    any = any || coupled_dlambda_[at(r)] != 0;
  }
  if (!any) return;
  std::fill(coupled_dx_.begin(), coupled_dx_.end(), Vec3{});
  std::fill(coupled_force_.begin(), coupled_force_.end(), Vec3{});
  part.add_times(coupled_dx_, coupled_dlambda_, coupled_force_);
  add_scaled_forces(-1, coupled_force_, rhs_);
}

bool Kkt::solve_coupled(const UnsymmetricPart* part, std::span<const std::uint8_t> clamped,
                        std::span<const Vec3> node_rhs, std::span<const double> row_rhs, double tolerance,
                        std::span<Vec3> dx, std::span<double> dlambda, StageSeconds& seconds) {
  const Stopwatch watch(seconds.solve);
  if (!gmres_ || !take_held(clamped)) return false;
  begin_solve(node_rhs, row_rhs);
  if (part != nullptr) move_constant_part(*part);
  const int steps = gmres_->solve(
      rhs_, solution_, tolerance,
      [&](std::span<const double> u, std::span<double> w) { coupled_times(part, clamped, u, w); },
      [&](std::span<double> u) { return factored_->precondition(u); });
  if (steps < 0) return false;
  residual_ = gmres_->start_norm() > 0 ? gmres_->left() / gmres_->start_norm() : 0;
  end_solve(row_rhs, dx, dlambda);
  return residual_ <= tolerance;
}

}  // namespace isochor
