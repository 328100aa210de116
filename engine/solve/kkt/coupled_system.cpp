#include "engine/solve/kkt/coupled_system.h"

#include <algorithm>

namespace isochor {

namespace {

constexpr int most_directions = 20;

}  // namespace

CoupledSystem::CoupledSystem(const System& system, FactoredMatrix& matrix, const ScaledUnknowns& unknowns,
                             RowJacobian& jacobian, CondensedRows& condensed)
    : system_(system),
      matrix_(matrix),
      unknowns_(unknowns),
      jacobian_(jacobian),
      condensed_(condensed),
      gmres_(at(system.kkt().size), most_directions),
      condensed_index_(at(system.rows()), -1),
      dx_(at(system.nodes())),
      force_(at(system.nodes())),
      dlambda_(at(system.rows()), 0) {
  const auto& rows = system.treated().condensed.row;
  for (std::size_t k = 0; k < rows.size(); ++k) condensed_index_[at(rows[k])] = static_cast<Index>(k);
  changed_.reserve(at(system.rows()));
  if (!system.has_bounds()) return;
  jacobian.take_memory();
  factored_held_.assign(at(system.rows()), 0);
  movable_.assign(at(system.rows()), 1);
  own_compliance_.assign(at(system.rows()), 0);
  take_new_numbers();
  for (const LawPlace& law : system.laws()) {
    std::fill_n(movable_.begin() + system.first_row(law.row_pool),
                system.parts().row_pools[at(law.row_pool)]->rows(), std::uint8_t{0});
  }
}

void CoupledSystem::take_new_numbers() {
  if (own_compliance_.empty()) return;
  std::fill(own_compliance_.begin(), own_compliance_.end(), 0.0);
  for (const ComplianceEntry& e : system_.compliance()) {
    if (e.row == e.col)
      own_compliance_[at(e.row)] += e.value;
    else
      movable_[at(e.row)] = movable_[at(e.col)] = 0;
  }
}

void CoupledSystem::assemble(const MatrixValues& values) {
  if (factored_held_.empty()) return;
  if (values.clamped.empty())
    std::fill(factored_held_.begin(), factored_held_.end(), std::uint8_t{0});
  else
    std::copy(values.clamped.begin(), values.clamped.end(), factored_held_.begin());
}

bool CoupledSystem::holds(std::span<const std::uint8_t> held) const {
  for (std::size_t r = 0; r < factored_held_.size(); ++r) {
    if ((factored_held_[r] != 0) != (!held.empty() && held[r] != 0)) return false;
  }
  return true;
}

bool CoupledSystem::choose(const UnsymmetricPart* part, std::span<const std::uint8_t> held_now) {
  part_ = part;
  held_ = held_now;
  changed_.clear();
  for (std::size_t r = 0; r < factored_held_.size(); ++r) {
    const bool now = held(static_cast<Index>(r));
    const Index k = condensed_index_[r];
    if (k >= 0) condensed_.hold(at(k), now);
    if (now == (factored_held_[r] != 0)) continue;
    if (k < 0 && movable_[r] == 0) return false;
    changed_.push_back(static_cast<Index>(r));
  }
  return true;
}

void CoupledSystem::reduce(std::span<double> rhs) {
  if (part_ == nullptr) return;
  bool any = false;
  for (const Index r : part_->rows()) {
    const Index k = condensed_index_[at(r)];
    const bool free = k >= 0 && !condensed_.held(at(k));
    dlambda_[at(r)] = free ? -condensed_.part(at(k)) : 0;
    any = any || dlambda_[at(r)] != 0;
  }
  if (!any) return;
  std::fill(dx_.begin(), dx_.end(), Vec3{});
  std::fill(force_.begin(), force_.end(), Vec3{});
  part_->add_times(dx_, dlambda_, force_);
  unknowns_.add_forces(-1, force_, rhs);
}

bool CoupledSystem::solve(double tolerance) {
  const int steps = gmres_.solve(
      matrix_.rhs(), matrix_.solution(), tolerance,
      [&](std::span<const double> u, std::span<double> w) { times(u, w); },
      [&](std::span<double> u) { return matrix_.precondition(u); });
  if (steps < 0) return false;
  matrix_.set_residual(gmres_.start_norm() > 0 ? gmres_.left() / gmres_.start_norm() : 0);
  return true;
}

// w = (A + L) u, A with the rows that are held now; multipliers of condensed rows follow the steps of the
// nodes, those held at a bound have their step on the right-hand side.
void CoupledSystem::times(std::span<const double> u, std::span<double> w) {
  matrix_.times(u, w);
  add_changed_rows(u, w);
  if (part_ != nullptr) add_part(u, w);
}

void CoupledSystem::add_changed_rows(std::span<const double> u, std::span<double> w) const {
  for (const Index r : changed_) {
    const bool released = factored_held_[at(r)] != 0;
    const double sign = released ? 1 : -1;
    const Index k = condensed_index_[at(r)];
    if (k >= 0) {
      jacobian_.add_force(r, sign * jacobian_.dot(r, u) / condensed_.compliance(at(k)), w);
      continue;
    }
    // A row that is an unknown: its entries, and the diagonal in place of them while it is held.
    const std::size_t unknown = at(system_.treated().unknown[at(r)]);
    const double scale = unknowns_.scale()[unknown], step = u[unknown];
    jacobian_.add_force(r, sign * scale * step, w);
    w[unknown] = released ? scale * (jacobian_.dot(r, u) - own_compliance_[at(r)] * scale * step)
                          : -system_.row_metric()[at(r)] * scale * scale * step;
  }
}

void CoupledSystem::add_part(std::span<const double> u, std::span<double> w) {
  unknowns_.to_nodes(u, dx_);
  for (const Index r : part_->rows()) {
    double& step = dlambda_[at(r)] = 0;
    if (held(r)) continue;
    const Index unknown = system_.treated().unknown[at(r)], k = condensed_index_[at(r)];
    if (unknown >= 0)
      step = unknowns_.scale()[at(unknown)] * u[at(unknown)];
    else if (k >= 0)
      step = jacobian_.dot(r, u) / condensed_.compliance(at(k));
  }
  std::fill(force_.begin(), force_.end(), Vec3{});
  part_->add_times(dx_, dlambda_, force_);
  unknowns_.add_forces(1, force_, w);
}

}  // namespace isochor
