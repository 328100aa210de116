#include "engine/solve/kkt/factored_matrix.h"

#include <algorithm>

namespace isochor {

FactoredMatrix::FactoredMatrix(const System& system, const Parallel& parallel,
                               std::unique_ptr<LinearSolver> solver)
    : system_(system),
      symmetric_{std::move(solver), false},
      factored_(symmetric_.solver.get()),
      values_(static_cast<std::size_t>(system.kkt().nonzeros())),
      rhs_(at(system.kkt().size)),
      solution_(at(system.kkt().size)) {
  factored_->set_parallel(parallel);
  if (factored_->wants_geometry()) describe_unknowns();
}

void FactoredMatrix::describe_unknowns() {
  const NodeUnknowns& nodes = system_.unknowns();
  std::vector<UnknownGeometry> geometry;
  geometry.reserve(at(system_.free_unknowns()));
  for (Index i = 0; i < system_.nodes(); ++i) {
    for (int c = 0; c < nodes.of(i); ++c) {
      Vec3 direction{};
      direction[c] = 1;
      geometry.push_back({i, system_.parts().rest[at(i)], nodes.from_free(i, direction)});
    }
  }
  symmetric_.solver->set_geometry(std::move(geometry));
}

void FactoredMatrix::take_unsymmetric(std::unique_ptr<LinearSolver> solver) {
  unsymmetric_.solver = std::move(solver);
  both_triangles_.resize(2 * values_.size());
}

void FactoredMatrix::set_interrupt(const std::function<bool()>& asked) {
  interrupt_ = asked;
  symmetric_.solver->set_interrupt(asked);
  if (unsymmetric_.solver) unsymmetric_.solver->set_interrupt(asked);
}

FactorOutcome FactoredMatrix::factor(std::span<const double> scale, StageSeconds& seconds) {
  return factor_by(symmetric_, values_, scale, seconds);
}

FactorOutcome FactoredMatrix::factor_unsymmetric(const UnsymmetricPart& part, std::span<const double> scale,
                                                 std::span<const std::uint8_t> held, StageSeconds& seconds) {
  {
    const Stopwatch watch(seconds.gather);
    const auto lower = std::span(both_triangles_).first(values_.size());
    const auto upper = std::span(both_triangles_).subspan(values_.size());
    std::copy(values_.begin(), values_.end(), lower.begin());
    std::copy(values_.begin(), values_.end(), upper.begin());
    for (const std::int64_t k : system_.matrix().diagonal) {
      if (k >= 0) upper[static_cast<std::size_t>(k)] = 0;
    }
    part.add_to(scale, held, lower, upper);
  }
  return factor_by(unsymmetric_, both_triangles_, scale, seconds);
}

FactorOutcome FactoredMatrix::factor_by(Backend& backend, std::span<const double> values,
                                        std::span<const double> scale, StageSeconds& seconds) {
  inertia_was_wrong_ = false;
  LinearSolver& solver = *backend.solver;
  if (!backend.analyzed) {
    const Stopwatch watch(seconds.analyze);
    const FactorReport f = solver.analyze(system_.kkt());
    ++counts_.analyses;
    if (f.status != FactorStatus::ok) return {f.status, -1, f.message};
    backend.analyzed = true;
  }
  const Stopwatch watch(seconds.factor);
  solver.set_scale(scale);
  const FactorReport f = solver.factor(values);
  factored_ = &solver;
  counts_.factor_nonzeros = f.factor_nonzeros;
  return {f.status, f.negative_pivots, f.message};
}

bool FactoredMatrix::solve(StageSeconds& seconds, double tolerance) {
  const Stopwatch watch(seconds.solve);
  const SolveReport solved = factored_->solve_to(tolerance, rhs_, solution_);
  residual_ = std::max(residual_, solved.residual);
  counts_.iterations += solved.iterations;
  inertia_was_wrong_ = inertia_was_wrong_ || solved.inertia_changed;
  return solved.ok;
}

bool FactoredMatrix::solve_beside(std::span<const double> rhs, std::span<double> solution) {
  const SolveReport solved = factored_->solve(rhs, solution);
  inertia_was_wrong_ = inertia_was_wrong_ || solved.inertia_changed;
  return solved.ok;
}

void FactoredMatrix::times(std::span<const double> u, std::span<double> w) const {
  const SymmetricPattern& kkt = system_.kkt();
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
  if (system_.shares()) system_.shares()->sum(w);
}

}  // namespace isochor
