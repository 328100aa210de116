#include "engine/solve/kkt/kkt.h"

#include <algorithm>
#include <cmath>

namespace isochor {

namespace {

double largest(std::span<const double> v) {
  double size = 0;
  for (const double x : v) size = std::max(size, std::abs(x));
  return size;
}

}  // namespace

Kkt::Kkt(std::shared_ptr<const System> system, const Parallel& parallel, std::unique_ptr<LinearSolver> solver)
    : system_(std::move(system)),
      parallel_(parallel),
      matrix_(*system_, parallel, std::move(solver)),
      unknowns_(*system_),
      jacobian_(*system_, unknowns_.scale()),
      kept_(*system_),
      condensed_(*system_, jacobian_),
      bordered_(*system_, matrix_, jacobian_),
      dual_(*system_, matrix_, bordered_, jacobian_) {
  const TreatedRows& rows = system_->treated();
  if (!rows.condensed.row.empty() || !rows.bordered.empty() || !rows.dual.empty()) jacobian_.take_memory();
}

void Kkt::assemble(const Assembly& assembly, const Values& values) {
  const auto matrix = matrix_.values();
  const bool filled = system_->treated().fill();
  // Places that only filled rows write to have no other owner.
  if (filled) std::fill(matrix.begin(), matrix.end(), 0.0);
  assembly.kkt_values(values.mass_scale, matrix);
  jacobian_.assemble(assembly);
  kept_.assemble(values, matrix);
  if (coupled_) coupled_->assemble(values);
  unknowns_.choose(values, matrix);
  condensed_.assemble(values, matrix);
  dual_.assemble(values, matrix);
  if (filled) unknowns_.choose_again(matrix);
  unknowns_.apply(parallel_, matrix);
  if (values.trace > 0) kept_.add_trace(values.trace, matrix, matrix_.rhs());
}

Kkt::Outcome Kkt::factor(const Assembly& assembly, const Values& values, StageSeconds& seconds) {
  {
    const Stopwatch watch(seconds.gather);
    assemble(assembly, values);
  }
  if (values.unsymmetric)
    return matrix_.factor_unsymmetric(*values.unsymmetric, unknowns_.scale(), values.clamped, seconds);
  const Outcome outcome = factor_symmetric(values, seconds);
  return matrix_.inertia_was_wrong() ? factor_symmetric(values, seconds) : outcome;
}

Kkt::Outcome Kkt::factor_symmetric(const Values& values, StageSeconds& seconds) {
  Outcome outcome = matrix_.factor(unknowns_.scale(), seconds);
  if (outcome.status != FactorStatus::ok) return outcome;
  // A condensed row has its negative pivot in -C, eliminated first; a dual one in its Schur complement, whose
  // sign is right whenever that of the (augmented) stiffness is.
  if (outcome.negative >= 0)
    outcome.negative += static_cast<Index>(condensed_.count() + system_->treated().dual.size());
  bordered_.assemble(values, outcome);
  return outcome;
}

void Kkt::reduce(std::span<const Vec3> node_rhs, std::span<const double> row_rhs) {
  const auto rhs = matrix_.rhs();
  matrix_.clear_residual();
  unknowns_.from_nodes(node_rhs, rhs);
  kept_.reduce(row_rhs, unknowns_.scale(), rhs);
  const double asked = largest(rhs);
  condensed_.reduce(row_rhs, rhs);
  const double with_rows = condensed_.count() > 0 ? largest(rhs) : asked;
  share_ = with_rows > asked ? asked / with_rows : 1;
  bordered_.reduce(row_rhs);
  dual_.reduce(row_rhs, rhs);
}

void Kkt::recover(std::span<const double> row_rhs, std::span<Vec3> dx, std::span<double> dlambda) {
  const auto solution = matrix_.solution();
  bordered_.recover(dlambda);
  dual_.recover(row_rhs, dlambda);
  condensed_.recover(row_rhs, solution, dlambda);
  kept_.recover(solution, unknowns_.scale(), dlambda);
  unknowns_.to_nodes(solution, dx);
}

bool Kkt::solve(std::span<const Vec3> node_rhs, std::span<const double> row_rhs, std::span<Vec3> dx,
                std::span<double> dlambda, StageSeconds& seconds, double tolerance) {
  reduce(node_rhs, row_rhs);
  const bool ok = system_->treated().dual.empty() ? bordered_.solve(seconds, share_ * tolerance)
                                                  : dual_.solve(row_rhs, seconds);
  recover(row_rhs, dx, dlambda);
  return ok;
}

bool Kkt::solve_coupled(const UnsymmetricPart* part, std::span<const std::uint8_t> clamped,
                        std::span<const Vec3> node_rhs, std::span<const double> row_rhs, double tolerance,
                        std::span<Vec3> dx, std::span<double> dlambda, StageSeconds& seconds) {
  const Stopwatch watch(seconds.solve);
  if (!coupled_ || !coupled_->choose(part, clamped)) return false;
  reduce(node_rhs, row_rhs);
  coupled_->reduce(matrix_.rhs());
  if (!coupled_->solve(tolerance)) return false;
  recover(row_rhs, dx, dlambda);
  return matrix_.residual() <= tolerance;
}

bool Kkt::solve_stiffness(std::span<const Vec3> node_rhs, std::span<Vec3> dx, StageSeconds& seconds) {
  matrix_.clear_residual();
  unknowns_.from_nodes(node_rhs, matrix_.rhs());
  bordered_.reduce({});
  const bool ok = bordered_.solve(seconds);
  unknowns_.to_nodes(matrix_.solution(), dx);
  return ok;
}

}  // namespace isochor
