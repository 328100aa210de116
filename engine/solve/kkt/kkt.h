// The linear systems of Newton's method: matrix of the saddle point, scaled and factored; right-hand sides
// in, steps of positions and multipliers out. Rows come in as they are treated: kept in the matrix, condensed
// into the stiffness (their compliance is invertible), bordered (eliminated around the factorization) or dual
// (conjugate gradients on their multipliers around the factorization).
#pragma once

#include <optional>

#include "engine/math/gmres.h"
#include "engine/solve/kkt/unsymmetric_part.h"
#include "isochor/work.h"

namespace isochor {

class Stopwatch {
 public:
  explicit Stopwatch(double& total);
  ~Stopwatch();
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& total_;
  double start_;
};

class Kkt {
 public:
  Kkt(std::shared_ptr<const System> system, const Parallel& parallel, std::unique_ptr<LinearSolver> solver);

  // What one matrix is made of, besides the last evaluation of the assembly (Want::hessian).
  struct Values {
    double mass_scale = 0;                  // [1/s^2]
    double shift = 0;                       // of the displacement block, relative to each node's stiffness
    std::span<const double> stiffness;      // reference of every node [N/m]
    std::span<const double> tangent;        // one for each System::compliance() entry; read where laws are
    std::span<const std::uint8_t> clamped;  // rows held at a bound; empty: none
    double trace = 0;  // compliance added to the matrix alone, relative; the equations solved are others
    // Makes the matrix unsymmetric, for the solver given to take_unsymmetric(); rows that have a share in it
    // are kept, and none are bordered or dual.
    const UnsymmetricPart* unsymmetric = nullptr;
  };
  struct Outcome {
    FactorStatus status = FactorStatus::ok;
    Index negative =
        -1;  // negative pivots of the whole system, all rows counted; -1: the backend cannot tell
    std::string message;
  };
  Outcome factor(const Assembly& assembly, const Values& values, StageSeconds& seconds);

  // Hands over its solvers, with the memory they have, before it is destroyed.
  std::unique_ptr<LinearSolver> release_solver() { return std::move(solver_); }
  std::unique_ptr<LinearSolver> release_unsymmetric() { return std::move(unsymmetric_solver_); }
  // Who factors unsymmetric matrices.
  void take_unsymmetric(std::unique_ptr<LinearSolver> solver);

  // Solves for the steps: node_rhs over all nodes (what falls on given directions is ignored), row_rhs over
  // all compliant rows in the sign of [K, G^T; G, -C]. Returns false when the residual is not acceptable.
  bool solve(std::span<const Vec3> node_rhs, std::span<const double> row_rhs, std::span<Vec3> dx,
             std::span<double> dlambda, StageSeconds& seconds);

  // The same for a matrix next to the one last factored, whose factors precondition: with an unsymmetric part
  // added (null: none), and other rows held at a bound. Until the residual is `tolerance` of the
  // right-hand side, scaled unknowns in the Euclidean norm; false when it is not in the few steps there is
  // room for. prepare_coupled() takes the memory; without it, and where coupled_possible() says no, nothing
  // is solved.
  bool coupled_possible() const { return system_->bordered_rows().empty() && system_->dual_rows().empty(); }
  void prepare_coupled();
  bool holds(std::span<const std::uint8_t> clamped) const;  // whether the factors hold these rows
  bool solve_coupled(const UnsymmetricPart* part, std::span<const std::uint8_t> clamped,
                     std::span<const Vec3> node_rhs, std::span<const double> row_rhs, double tolerance,
                     std::span<Vec3> dx, std::span<double> dlambda, StageSeconds& seconds);

  // For systems whose rows are all dual. Weights W of the augmentation, one a row, for given values; then,
  // with the matrix factored: dx = A^-1 node_rhs, and q = T^T (C + G A^-1 G^T T) p as kkt_dual.cpp has it.
  std::span<const double> dual_weights(const Values& values) {
    prepare_dual(values);
    return weight_;
  }
  bool solve_stiffness(std::span<const Vec3> node_rhs, std::span<Vec3> dx, StageSeconds& seconds);
  bool apply_dual(std::span<const double> p, std::span<double> q, StageSeconds& seconds);
  // v becomes T^T v.
  void weigh_transposed(std::span<double> v);
  std::span<const double> dual_preconditioner() const { return preconditioner_; }

  // As LinearSolver::set_interrupt(), for all its solvers and its own iterations.
  void set_interrupt(const std::function<bool()>& asked);

  LinearSolver& linear_solver() { return *solver_; }
  double residual() const { return residual_; }  // of the last solve, relative
  // The last solve showed that the inertia told by factor() was wrong; another factor() tells the right one.
  bool inertia_was_wrong() const { return inertia_was_wrong_; }
  // Iterations of an iterative linear solver so far.
  std::int64_t linear_iterations() const { return linear_iterations_; }
  // Conjugate-gradient iterations on dual rows so far; each is one solve.
  std::int64_t dual_iterations() const { return dual_iterations_; }
  // Relative residual at which they end, in the norm of the preconditioner.
  double dual_tolerance = 1e-8;
  int dual_iteration_limit = 500;
  std::int64_t factor_nonzeros() const { return factor_nonzeros_; }
  int analyses() const { return analyses_; }

 private:
  void describe_unknowns();
  void scale_unknowns(const Values& values);
  void add_trace(double trace);
  void add_filled(const Values& values);
  void prepare_dual(const Values& values);
  Outcome factor_values(LinearSolver& solver, bool& analyzed, std::span<const double> values,
                        StageSeconds& seconds);
  void begin_solve(std::span<const Vec3> node_rhs, std::span<const double> row_rhs);
  void end_solve(std::span<const double> row_rhs, std::span<Vec3> dx, std::span<double> dlambda);
  bool take_held(std::span<const std::uint8_t> clamped);
  void coupled_times(const UnsymmetricPart* part, std::span<const std::uint8_t> clamped,
                     std::span<const double> u, std::span<double> w);
  void move_constant_part(const UnsymmetricPart& part);
  void matrix_times(std::span<const double> u, std::span<double> w) const;
  void add_scaled_forces(double factor, std::span<const Vec3> force, std::span<double> w) const;
  bool solve_matrix(StageSeconds& seconds);
  bool solve_dual(std::span<const double> row_rhs, StageSeconds& seconds);
  void to_unknowns(std::span<const Vec3> node_rhs);
  void to_nodes(std::span<const double> u, std::span<Vec3> dx) const;
  void weigh(std::span<const double> v, std::span<double> out) const;
  void add_dual_compliance(double alpha, std::span<const double> v, std::span<double> y) const;
  void add_row_force(Index row, double multiplier, std::span<double> w) const;
  double row_dot(Index row, std::span<const double> v) const;
  Outcome factor_scaled(const Values& values, StageSeconds& seconds);
  Outcome eliminate_border(const Values& values, Outcome outcome);
  void border_column(Index row, std::span<double> column) const;
  double compliance_of(const Values& values, std::size_t entry) const;

  std::function<bool()> interrupt_;
  bool interrupted() const { return interrupt_ && interrupt_(); }

  std::shared_ptr<const System> system_;
  const Parallel& parallel_;
  std::unique_ptr<LinearSolver> solver_;
  std::int64_t factor_nonzeros_ = 0;
  int analyses_ = 0;
  std::int64_t linear_iterations_ = 0;
  bool analyzed_ = false, inertia_was_wrong_ = false;
  // Of unsymmetric matrices: the solver, and the two triangles. `factored_` did the last matrix.
  std::unique_ptr<LinearSolver> unsymmetric_solver_;
  bool unsymmetric_analyzed_ = false;
  std::vector<double> both_triangles_;
  LinearSolver* factored_;
  double residual_ = 0;
  std::vector<double> values_, scale_, rhs_, solution_;
  // For matrices next to the one factored: which condensed row a row is (-1: none), what the factors hold at
  // a bound, rows that are held and free the other way round, which rows
  // may be, and steps and forces of nodes.
  std::optional<Gmres> gmres_;
  std::vector<std::uint8_t> factored_held_, movable_;
  std::vector<double> free_compliance_, own_compliance_;
  std::vector<Index> changed_;
  std::vector<Index> condensed_index_;
  std::vector<Vec3> coupled_dx_, coupled_force_;
  std::vector<double> coupled_dlambda_;
  // Rows outside the matrix: their Jacobian in free directions, the compliance of condensed ones and, for the
  // border, A^-1 B and the factored Schur complement.
  std::vector<Vec3> row_jacobian_;
  static constexpr double kHeld = 0;  // in place of the compliance of a condensed row that is held at a bound
  std::vector<double> condensed_compliance_, condensed_part_;
  std::vector<double> border_solution_, schur_, schur_vectors_, border_value_, border_work_, border_rhs_,
      border_kept_;
  // Dual rows, over all rows: weights W of the augmentation, compliance values, preconditioner, 1 where a row
  // takes part, and the vectors of the iteration.
  std::int64_t dual_iterations_ = 0;
  std::vector<double> weight_, dual_value_, preconditioner_, active_;
  std::vector<double> cg_x_, cg_r_, cg_z_, cg_p_, cg_q_, cg_work_, cg_rhs_, matrix_rhs_;
};

}  // namespace isochor
