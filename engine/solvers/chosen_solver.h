// What `automatic` is: a direct solver, or the iterative one where factors would not fit into memory or where
// it is preferred; and the other one after the first has failed.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/solvers/linear_solver.h"

namespace isochor {

struct ChoiceOptions {
  // Factors beyond this are not tried [bytes]. 0: three fifths of the machine's memory.
  double memory = 0;
  // Where factors fit as well.
  bool prefer_iterative = false;
};

// Choices depend on pattern, matrices and the size of the machine's memory, never on times or on what else
// runs there, so that a run can be repeated to the bit.
class ChosenSolver final : public LinearSolver {
 public:
  ChosenSolver(std::unique_ptr<LinearSolver> direct, std::unique_ptr<LinearSolver> iterative,
               const ChoiceOptions& options);

  std::string_view name() const override { return now_->name(); }
  std::string reason() const override;
  void set_parallel(const Parallel& parallel) override;
  void set_interrupt(std::function<bool()> asked) override;
  bool wants_geometry() const override { return true; }
  void set_geometry(std::vector<UnknownGeometry> geometry) override;
  void set_scale(std::span<const double> scale) override;
  void begin_solve() override;

  FactorReport analyze(const SymmetricPattern& pattern) override;
  FactorReport factor(std::span<const double> values) override;
  SolveReport solve(std::span<const double> right_hand_side, std::span<double> solution) override {
    return solve_to(0, right_hand_side, solution);
  }
  SolveReport solve_to(double tolerance, std::span<const double> right_hand_side,
                       std::span<double> solution) override;
  bool precondition(std::span<double> x) override { return now_->precondition(x); }

 private:
  bool use_direct(std::string reason, FactorReport& report);
  bool use_iterative(std::string reason, FactorReport& report);

  std::unique_ptr<LinearSolver> direct_, iterative_;
  LinearSolver* now_;
  double memory_;
  bool prefer_iterative_;
  bool direct_fits_ = true, iterative_failed_ = false;
  std::string reason_;
  const SymmetricPattern* pattern_ = nullptr;
  std::span<const double> values_;
};

// Three fifths of the memory that the machine has [bytes].
double memory_for_factors();

}  // namespace isochor
