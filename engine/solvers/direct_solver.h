// What all direct backends share: checked input, iterative refinement in full precision, and the report.
#pragma once

#include <limits>
#include <vector>

#include "engine/solvers/linear_solver.h"

namespace isochor {

// A backend implements the three protected functions for a non-empty, well-formed matrix with finite values.
class DirectSolver : public LinearSolver {
 public:
  // Of matrices given by one triangle or by two (LinearSolver::factor).
  explicit DirectSolver(bool two_triangles = false) : two_triangles_(two_triangles) {}

  FactorReport analyze(const SymmetricPattern& pattern) final;
  FactorReport factor(std::span<const double> values) final;
  SolveReport solve(std::span<const double> right_hand_side, std::span<double> solution) final {
    return solve_to(0, right_hand_side, solution);
  }
  SolveReport solve_to(double tolerance, std::span<const double> right_hand_side,
                       std::span<double> solution) final;
  bool precondition(std::span<double> x) final;

 protected:
  virtual FactorReport analyze_pattern() = 0;
  virtual FactorReport factor_values() = 0;
  // Overwrites a right-hand side with the factor's solution of it; false when the backend fails.
  virtual bool apply_inverse(std::span<double> x) = 0;

  // True when the last refine() arrived but its factors are not to be trusted.
  virtual bool doubtful() const { return false; }
  // Called when refinement on the factors at hand did not arrive: true when there are better ones now and the
  // solve is worth another try.
  virtual bool strengthen(SolveReport& report) {
    (void)report;
    return false;
  }

  // The refined solution and how good it is; `tolerance` as of solve_to(), in the maximum norm. Also what a
  // backend asks a doubtful factor with.
  SolveReport refine(std::span<const double> b, std::span<double> x, double tolerance = 0);

  bool two_triangles() const { return two_triangles_; }
  const SymmetricPattern& pattern() const { return *pattern_; }
  std::span<const double> values() const { return values_; }
  double norm() const { return norm_; }  // infinity norm of the values last given to factor
  // Of the last refine(): the largest ratio of residuals, in the norm of the right-hand side, from one
  // refinement to the next; 0 when none was needed beyond rounding. The relative residual may fall although
  // nothing converges, when the solution grows beyond bounds.
  double residual_ratio() const { return residual_ratio_; }
  double last_residual_norm() const { return residual_norm_; }
  int max_refinements = 5;
  // Where refinement ends: by default where it would only shuffle the last bits.
  double target_residual = 2 * std::numeric_limits<double>::epsilon();

 private:
  SolveReport refine_as_needed(std::span<const double> b, std::span<double> x, double tolerance);
  // residual = b - A x; returns its infinity norm, NaN included.
  double compute_residual(std::span<const double> b, std::span<const double> x);

  bool two_triangles_;
  const SymmetricPattern* pattern_ = nullptr;
  std::span<const double> values_;
  std::vector<double> residual_, correction_, best_;
  double norm_ = 0, residual_norm_ = 0, residual_ratio_ = 0;
  bool factored_ = false;
  bool proven_ = false;  // a right-hand side was refined on these factors
};

}  // namespace isochor
