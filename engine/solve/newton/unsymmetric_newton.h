// Newton's method where some pools couple (LaggedStencils::couples): their forces follow from no potential,
// the matrix is unsymmetric, and there is neither an inertia to watch nor a merit function.
//
// A step is searched on the size of the residual,
//   R^2 = sum |r_i|^2 / k_i + sum D_r (projection(lambda + theta / D) - lambda)^2 + sum k_i |gap_i|^2,
// an energy: the norms of Evaluator::measure with metrics in place of measures. An exact Newton step
// descends it as long as the set of rows held at bounds stays. Where two fifths of a step do not make it
// smaller, the lag is held, symmetric and with the merit of Newton: for one iteration, one more with every
// time, and until that set has stayed over a full step. An iteration in which nothing makes the matrix
// unsymmetric is one of Newton anyway.
#pragma once

#include "engine/solve/newton/newton.h"

namespace isochor {

class UnsymmetricNewton final : public Newton {
 public:
  // `unsymmetric` is of make_unsymmetric_solver(); `solver` is for iterations that hold the lag.
  UnsymmetricNewton(std::shared_ptr<const System> system, const Parallel& parallel,
                    std::unique_ptr<LinearSolver> solver, std::unique_ptr<LinearSolver> unsymmetric);

 protected:
  SaddleReport solve_from_here(const SaddleProblem& problem, const SaddleOptions& options) override;

 private:
  bool coupled_step(const SaddleProblem& p, const SaddleOptions& options, SaddleReport& report);
  bool lagged_step(const SaddleProblem& p, SaddleReport& report);
  bool find_coupled(SaddleReport& report);
  bool polish(const SaddleProblem& p, const SaddleOptions& options, SaddleReport& report);
  double residual_energy(const Iterate& it, double gap_left) const;

  bool factors_alone_ = false;             // steps on symmetric factors have failed in this solve
  std::vector<std::uint8_t> held_before_;  // rows held at a bound, an iteration ago
};

}  // namespace isochor
