// Multifrontal L D L^T without pivoting on fronts of our own, in single precision where that is good enough.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/solvers/direct_solver.h"
#include "engine/solvers/front/front_factor.h"

namespace isochor {

struct MultifrontalOptions {
  bool single_precision = true;  // first; the answers are refined to the same residual
  // Multiplications of a factorization from which on that pays: below, refinement costs what it saves.
  double single_from = 1e8;
  OrderingMethod ordering = OrderingMethod::best;
};

// A ladder: factors in single precision, in double precision, and those of a backend that pivots. The
// solution is refined in double precision on every rung, to the same residual.
//
// What makes a rung good enough is that refinement contracts. With factors of A + E it multiplies the error
// by (A + E)^-1 E. Were A + tE singular for a t in (0, 1], 1 / (1 - t) > 1 would be an eigenvalue of that
// matrix and refinement would not converge; so where it does, A and A + E have the same inertia (no
// eigenvalue passes zero on the way), and the pivots tell that of A. The right-hand side need not have a part
// in the dangerous direction: the rounding errors of the first solve, E x, have one. A number of negative
// pivots that is not what the rows call for is checked this way before it is reported, the right one by the
// first solve.
class MultifrontalSolver final : public DirectSolver {
 public:
  MultifrontalSolver(std::unique_ptr<LinearSolver> pivoting, const MultifrontalOptions& options);

  std::string_view name() const override { return "multifrontal"; }
  std::string reason() const override;
  void set_parallel(const Parallel& parallel) override;
  void set_interrupt(std::function<bool()> asked) override;
  void set_scale(std::span<const double> scale) override;
  void begin_solve() override;

  enum class Rung : std::uint8_t { single, full, pivoting };
  Rung rung() const { return rung_; }
  const FrontTree& tree() const { return *tree_; }

 protected:
  FactorReport analyze_pattern() override;
  FactorReport factor_values() override;
  bool apply_inverse(std::span<double> x) override;
  bool doubtful() const override;
  bool strengthen(SolveReport& report) override;

 private:
  FactorReport factor_from(Rung rung);
  bool factor_fronts(FactorReport& report);
  bool solves_well();
  FactorReport factor_pivoting();

  std::unique_ptr<LinearSolver> pivoting_;
  MultifrontalOptions options_;
  RowLoop loop_;
  std::shared_ptr<const FrontTree> tree_ = std::make_shared<const FrontTree>();
  FrontFactor<float> single_;
  FrontFactor<double> full_;
  bool pivoting_analyzed_ = false;
  Rung rung_ = Rung::single;    // of the last factors
  Rung lowest_ = Rung::single;  // that factorizations start from
  Index expected_ = -1, reported_ = -1;
  std::vector<float> narrow_;
  std::vector<double> copy_, test_right_, test_solution_;
  std::int64_t used_[3] = {0, 0, 0};
};

std::unique_ptr<LinearSolver> make_multifrontal_solver(std::unique_ptr<LinearSolver> pivoting,
                                                       const MultifrontalOptions& options = {});

}  // namespace isochor
