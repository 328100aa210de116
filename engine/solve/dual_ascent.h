// Dual ascent: positions minimize the energy for given multipliers, then the multipliers climb the dual
// function along its gradient with the steepest length (Francu, Asgeirsson, Erleben & Roennow 2021, eqs. 39
// to 41), projected on their bounds. One matrix of the size of the displacements, no saddle point.
//
// With weights W >= 0 the energy is the augmented Lagrangian
//   E(x) + lambda . phi - lambda . C lambda / 2 + theta . W theta / 2,   theta = phi - target - C lambda,
// whose stationary point is that of the saddle point for every W.
#pragma once

#include "engine/solve/saddle_point.h"

namespace isochor {

struct DualAscentOptions {
  bool augmented = true;  // W as DualRows chooses it, else 0
  // Climb along theta in units of the row metric. False: along theta as it is, which supposes rows of one
  // kind on an even mesh.
  bool scaled = true;
  // Climb along conjugate directions instead of the gradient: each is freed of the one before it, as the last
  // dual operator sees them.
  bool conjugate = false;
};

class DualAscent : public SaddlePoint {
 public:
  // All rows of the system must be dual.
  DualAscent(std::shared_ptr<const System> system, const Parallel& parallel,
             std::unique_ptr<LinearSolver> solver, DualAscentOptions options);

 protected:
  SaddleReport solve_from_here(const SaddleProblem& problem, const SaddleOptions& options) override;

 private:
  struct Descent;
  SaddleReport ascend(const SaddleProblem& p, const SaddleOptions& options);
  void evaluate(const SaddleProblem& p, Want want, Iterate& it);
  double lagrangian(const SaddleProblem& p, const Iterate& it) const;
  bool minimize(const SaddleProblem& p, const SaddleOptions& options, double tolerance, SaddleReport& report);
  bool spent(const SaddleOptions& options, const Descent& d, int iteration, const SaddleReport& report) const;
  bool direction(const SaddleProblem& p, Descent& d, SaddleReport& report);
  bool search(const SaddleProblem& p, Descent& d, SaddleReport& report);
  bool backtrack(const SaddleProblem& p, Descent& d, double tau, SaddleReport& report);
  double value_at(const SaddleProblem& p, double tau, SaddleReport& report);
  bool left_all_bounds() const;
  bool climb(SaddleReport& report);
  void find_climb();
  void conjugate();

  DualAscentOptions ascent_;
  bool factored_ = false;    // in this solve
  bool has_before_ = false;  // a direction to be conjugate to, in this solve
  bool any_held_ = false;
  std::vector<std::uint8_t> held_;  // rows at a bound; empty: no row has bounds
  // Multipliers lambda + W theta, projected; the ascent's direction, its image and the gradient; W.
  std::vector<double> effective_, direction_, image_, gradient_, weights_;
  std::vector<double> before_, image_before_;  // conjugate: the last direction and its image
  std::vector<Vec3> dx_, rhs_, node_work_, reaction_;
  std::vector<Vec3> x_before_, dx_before_;  // of the watchdog
};

}  // namespace isochor
