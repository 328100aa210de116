// The linear systems of Newton's method: right-hand sides of nodes and rows in, steps of positions and
// multipliers out. Every row is treated in one of four ways, each a part of its own: kept in the matrix,
// condensed into the stiffness (it has an invertible compliance), bordered (eliminated around the
// factorization) or dual (conjugate gradients on its multiplier around the factorization). A part has three
// calls: assemble() for a matrix, reduce() for a right-hand side, recover() for the multipliers.
//
// One factorization, in the order of factor():
//
//   gather      K + mass, G of the kept rows and -C to their places; Jacobian vectors of the other rows
//   kept        tangents of laws, and a diagonal in place of each row that is held at a bound
//   scale       unknowns to a unit diagonal, with the shift of the nodes
//   condensed   G^T G / C onto the stiffness
//   dual        G^T W G onto the stiffness, where it is augmented
//   scale again what these made stiffer; then S A S, and the trace of kept rows
//   factor      analyzing before the first
//   bordered    a solve for each row and the Schur complement, with its share of the inertia
//
// One solve, in the order of solve():
//
//   reduce      nodes, then kept (scaled), condensed (G^T g / C to the nodes), bordered (set aside),
//               dual (G^T W g to the nodes)
//   solve       the matrix, the border around it and conjugate gradients around both
//   recover     multipliers of the bordered, dual, condensed and kept rows, and the steps of the nodes
#pragma once

#include <optional>

#include "engine/solve/kkt/coupled_system.h"
#include "engine/solve/kkt/dual_rows.h"
#include "engine/solve/kkt/kept_rows.h"

namespace isochor {

class Kkt {
 public:
  using Values = MatrixValues;
  using Outcome = FactorOutcome;

  Kkt(std::shared_ptr<const System> system, const Parallel& parallel, std::unique_ptr<LinearSolver> solver);

  // After an evaluation with Want::hessian.
  Outcome factor(const Assembly& assembly, const Values& values, StageSeconds& seconds);

  // Solves for the steps: node_rhs over all nodes (what falls on given directions is ignored), row_rhs over
  // all compliant rows in the sign of [K, G^T; G, -C]. `tolerance` as LinearSolver::solve_to(), but where
  // rows are dual. Returns false when the residual is not acceptable.
  bool solve(std::span<const Vec3> node_rhs, std::span<const double> row_rhs, std::span<Vec3> dx,
             std::span<double> dlambda, StageSeconds& seconds, double tolerance = 0);

  // The same for a matrix next to the one last factored, whose factors precondition: with an unsymmetric part
  // added (null: none), and other rows held at a bound. Until the residual is `tolerance` of the
  // right-hand side, scaled unknowns in the Euclidean norm; false when it is not in the few steps there is
  // room for. prepare_coupled() takes the memory; without it, and where coupled_possible() says no, nothing
  // is solved.
  bool coupled_possible() const {
    return system_->treated().bordered.empty() && system_->treated().dual.empty();
  }
  void prepare_coupled() { coupled_.emplace(*system_, matrix_, unknowns_, jacobian_, condensed_); }
  // The system has other numbers than before, in the same structure.
  void take_new_numbers() {
    if (coupled_) coupled_->take_new_numbers();
  }
  // Whether the factors hold these rows.
  bool holds(std::span<const std::uint8_t> clamped) const { return !coupled_ || coupled_->holds(clamped); }
  bool solve_coupled(const UnsymmetricPart* part, std::span<const std::uint8_t> clamped,
                     std::span<const Vec3> node_rhs, std::span<const double> row_rhs, double tolerance,
                     std::span<Vec3> dx, std::span<double> dlambda, StageSeconds& seconds);

  // For systems whose rows are all dual, and methods that iterate on multipliers themselves (DualRows). With
  // the matrix factored, dx = A^-1 node_rhs.
  bool solve_stiffness(std::span<const Vec3> node_rhs, std::span<Vec3> dx, StageSeconds& seconds);
  std::span<const double> dual_weights(const Values& values) { return dual_.weights(values); }
  bool apply_dual(std::span<const double> p, std::span<double> q, StageSeconds& seconds) {
    return dual_.apply(p, q, seconds);
  }
  void weigh_transposed(std::span<double> v) { dual_.weigh_transposed(v); }
  std::span<const double> dual_preconditioner() const { return dual_.preconditioner(); }

  LinearSolver& linear_solver() { return matrix_.solver(); }
  // Who factors unsymmetric matrices.
  void take_unsymmetric(std::unique_ptr<LinearSolver> solver) { matrix_.take_unsymmetric(std::move(solver)); }
  // Hands over its solvers, with the memory they have, before it is destroyed.
  std::unique_ptr<LinearSolver> release_solver() { return matrix_.release_solver(); }
  std::unique_ptr<LinearSolver> release_unsymmetric() { return matrix_.release_unsymmetric(); }
  // As LinearSolver::set_interrupt(), for all its solvers and its own iterations.
  void set_interrupt(const std::function<bool()>& asked) { matrix_.set_interrupt(asked); }

  double residual() const { return matrix_.residual(); }  // of the last solve, relative
  // The last solve showed that the inertia told by factor() was wrong; another factor() tells the right one.
  bool inertia_was_wrong() const { return matrix_.inertia_was_wrong(); }
  // Iterations of an iterative linear solver so far, and of conjugate gradients on dual rows.
  std::int64_t linear_iterations() const { return matrix_.counts().iterations; }
  std::int64_t dual_iterations() const { return dual_.iterations(); }
  std::int64_t factor_nonzeros() const { return matrix_.counts().factor_nonzeros; }
  int analyses() const { return matrix_.counts().analyses; }

 private:
  void assemble(const Assembly& assembly, const Values& values);
  Outcome factor_symmetric(const Values& values, StageSeconds& seconds);
  void reduce(std::span<const Vec3> node_rhs, std::span<const double> row_rhs);
  void recover(std::span<const double> row_rhs, std::span<Vec3> dx, std::span<double> dlambda);

  std::shared_ptr<const System> system_;
  const Parallel& parallel_;
  FactoredMatrix matrix_;
  ScaledUnknowns unknowns_;
  RowJacobian jacobian_;
  KeptRows kept_;
  CondensedRows condensed_;
  BorderedRows bordered_;
  DualRows dual_;
  std::optional<CoupledSystem> coupled_;
  // Of what is asked in the right-hand side: eliminated rows add residuals over their compliances, which
  // cancel and may be larger by orders of magnitude. Tolerances are of what is asked.
  double share_ = 1;
};

}  // namespace isochor
