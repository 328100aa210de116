// The matrix of a saddle point with the solvers that factor it, and the vectors that go through its factors.
#pragma once

#include "engine/base/stopwatch.h"
#include "engine/solve/kkt/unsymmetric_part.h"
#include "isochor/work.h"

namespace isochor {

// What came of a factorization.
struct FactorOutcome {
  FactorStatus status = FactorStatus::ok;
  Index negative = -1;  // negative pivots of the whole system, all rows counted; -1: the backend cannot tell
  std::string message;
};

class FactoredMatrix {
 public:
  FactoredMatrix(const System& system, const Parallel& parallel, std::unique_ptr<LinearSolver> solver);
  FactoredMatrix(const FactoredMatrix&) = delete;
  FactoredMatrix& operator=(const FactoredMatrix&) = delete;

  // Entries in the order of the pattern, lower triangle.
  std::span<double> values() { return values_; }
  // Right-hand side of solve(), and its solution; scaled unknowns.
  std::span<double> rhs() { return rhs_; }
  std::span<double> solution() { return solution_; }

  // Both analyze before the first factorization. `scale` as LinearSolver::set_scale(). The second one adds an
  // unsymmetric part; rows held at a bound have none.
  FactorOutcome factor(std::span<const double> scale, StageSeconds& seconds);
  FactorOutcome factor_unsymmetric(const UnsymmetricPart& part, std::span<const double> scale,
                                   std::span<const std::uint8_t> held, StageSeconds& seconds);

  void clear_residual() { residual_ = 0; }
  // `tolerance` as LinearSolver::solve_to().
  bool solve(StageSeconds& seconds, double tolerance = 0);
  // The same for another vector, in the course of a factorization.
  bool solve_beside(std::span<const double> rhs, std::span<double> solution);
  // u := M^-1 u with the factors as they are; false where there are none.
  bool precondition(std::span<double> u) { return factored_->precondition(u); }
  // w = A u, without an unsymmetric part.
  void times(std::span<const double> u, std::span<double> w) const;

  LinearSolver& solver() { return *symmetric_.solver; }
  void take_unsymmetric(std::unique_ptr<LinearSolver> solver);
  std::unique_ptr<LinearSolver> release_solver() { return std::move(symmetric_.solver); }
  std::unique_ptr<LinearSolver> release_unsymmetric() { return std::move(unsymmetric_.solver); }
  void set_interrupt(const std::function<bool()>& asked);
  bool interrupted() const { return interrupt_ && interrupt_(); }

  struct Counts {
    std::int64_t iterations = 0;  // of an iterative solver, in solve()
    std::int64_t factor_nonzeros = 0;
    int analyses = 0;
  };
  const Counts& counts() const { return counts_; }
  // Of solve(), relative: the largest since clear_residual().
  double residual() const { return residual_; }
  void set_residual(double residual) { residual_ = residual; }
  // A solve since the last factorization showed that its inertia was wrong; another one tells the right one.
  bool inertia_was_wrong() const { return inertia_was_wrong_; }

 private:
  struct Backend {
    std::unique_ptr<LinearSolver> solver;
    bool analyzed = false;
  };
  FactorOutcome factor_by(Backend& backend, std::span<const double> values, std::span<const double> scale,
                          StageSeconds& seconds);
  void describe_unknowns();

  const System& system_;
  Backend symmetric_, unsymmetric_;
  LinearSolver* factored_;  // who factored last
  std::function<bool()> interrupt_;
  std::vector<double> values_, both_triangles_, rhs_, solution_;
  Counts counts_;
  double residual_ = 0;
  bool inertia_was_wrong_ = false;
};

}  // namespace isochor
