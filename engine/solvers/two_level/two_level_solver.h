// Factors, or where those take several times the work two levels (two_level.h) inside of minimal residuals.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/solvers/gmres.h"
#include "engine/solvers/two_level/two_level.h"

namespace isochor {

struct TwoLevelChoice {
  // Two levels are taken where factors would take `pays` times their work, and no less than `from`
  // multiplications.
  double pays = 2, from = 5e9;
  // Whether the inertia behind solutions is looked at once more: where equilibria may be unstable.
  bool confirm = true;
  double tolerance = 1e-10;  // of what is to be as exact as can be
};

// Choices follow from the pattern, by multiplications counted, and from matrices. Factors take over for the
// rest of a saddle point where
//
//   the coarse matrix is singular
//   minimal residuals do not arrive
//   inertias have seemed wrong a dozen times
//   an equilibrium may be unstable, as the look at it says that is described below
//
// The next one starts with two levels again, so that results depend on the state and not on history.
//
// What is known of the inertia. The preconditioner's is that of the coarse matrix, exactly; a wrong one is
// reported. A right one is reported as unknown, so that directions are judged by the merit
// (Newton::descends). With every solution the sign of the Hessenberg determinant tells whether the matrix may
// differ, in directions in which the right-hand side has a part; then there is no solution, and the matrix is
// mended. Before a second right-hand side on the same matrix, which is where states are accepted, it is asked
// with one that has parts along all: factors decide where it objects.
class TwoLevelSolver final : public LinearSolver {
 public:
  TwoLevelSolver(std::unique_ptr<LinearSolver> direct, const TwoLevelChoice& choice);

  std::string_view name() const override { return two_levels_ ? "two_level" : direct_->name(); }
  std::string reason() const override;
  void set_parallel(const Parallel& parallel) override;
  bool wants_geometry() const override { return true; }
  void set_geometry(std::vector<UnknownGeometry> geometry) override;
  void set_interrupt(std::function<bool()> asked) override;
  void set_scale(std::span<const double> scale) override;
  void begin_solve() override;

  FactorReport analyze(const SymmetricPattern& pattern) override;
  FactorReport factor(std::span<const double> values) override;
  SolveReport solve(std::span<const double> right_hand_side, std::span<double> solution) override {
    return solve_to(0, right_hand_side, solution);
  }
  // In the Euclidean norm.
  SolveReport solve_to(double tolerance, std::span<const double> right_hand_side,
                       std::span<double> solution) override;
  bool precondition(std::span<double> x) override;

  // Whether it has two levels for this pattern, and works with them now.
  bool two_levels() const { return two_levels_; }
  bool at_work() const { return two_levels_ && !by_factors_; }
  TwoLevel& levels() { return *levels_; }

 private:
  bool pays(const SymmetricPattern& pattern);
  FactorReport factor_directly(std::string why);
  SolveReport solve_directly(std::string why, double tolerance, std::span<const double> b,
                             std::span<double> x, int iterations);
  bool iterate(double wanted, std::span<const double> b, std::span<double> x, int& iterations);
  bool same_inertia(int& iterations);

  std::unique_ptr<LinearSolver> direct_;
  TwoLevelChoice choice_;
  const Parallel* parallel_ = nullptr;
  std::unique_ptr<TwoLevel> levels_;  // null: never worth it
  std::optional<Gmres> gmres_;
  std::vector<UnknownGeometry> geometry_;
  const SymmetricPattern* pattern_ = nullptr;
  std::span<const double> values_, scale_;
  bool two_levels_ = false, by_factors_ = true, analyzed_ = false;
  Index reported_ = -1;  // negative pivots of the last matrix
  int wrong_ = 0;        // inertias of this saddle point
  int solutions_ = 0;    // of the last matrix
  double norm_ = 0;
  struct {
    std::vector<double> b, x, residual, work;
  } vectors_;
  std::string why_;           // factors took over, the last time
  int factored_[2] = {0, 0};  // matrices by two levels, and by factors in their place
};

std::unique_ptr<LinearSolver> make_two_level_solver(std::unique_ptr<LinearSolver> direct,
                                                    const TwoLevelChoice& choice);

}  // namespace isochor
