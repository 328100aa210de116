// The merit function of Newton's line search: one that a Newton direction always descends.
//
// Give every compliant row its own strain eta (so that phi(x) - target = C eta, with energy eta^T C eta / 2)
// and keep the new multiplier estimate l = lambda + dlambda fixed while searching:
//   P(x, eta) = E(x) + 1/2 eta^T C eta + l^T theta + gamma/2 theta^T D^-1 theta,  theta = phi(x) - target - C
//   eta.
// Along (dx, deta = dlambda) from eta = lambda its slope is
//   -(dx^T H dx + dlambda^T C dlambda) - gamma theta^T D^-1 theta,
// which is negative for a moderate gamma whenever the inertia of the saddle-point matrix is right, for every
// C >= 0 alike: nu = 0.5 and 0.4999 take the same path. Prescribed coordinates that have not reached their
// targets enter as hard rows whose multipliers are the reactions, so a large prescribed motion is searched
// like any other step.
#pragma once

#include "engine/solve/evaluator.h"

namespace isochor {

// A Newton step: displacements, and the multipliers at its end.
struct Direction {
  std::vector<Vec3> dx;
  std::vector<double> lambda;
};

// Rows whose multipliers a linear system holds at a bound: which, the bound, and the way of the multiplier
// there.
struct HeldRows {
  bool any = false;
  std::vector<std::uint8_t> held;  // empty: no row has bounds
  std::vector<double> bound, way;

  std::span<const std::uint8_t> rows() const {
    return any ? std::span<const std::uint8_t>(held) : std::span<const std::uint8_t>();
  }
  bool holds(std::size_t row) const { return any && held[row] != 0; }
};

class Merit {
 public:
  explicit Merit(Evaluator& evaluator);

  void begin() { gamma_ = smallest_gamma; }  // of a solve
  // Slope along the direction from the iterate, where the last evaluation was; raises gamma until it is
  // safely negative.
  double slope(const Iterate& now, const Direction& step, const HeldRows& held, const Gap& gap);
  // At an iterate that is tau along the direction of the last slope().
  double value(const SaddleProblem& p, double tau, const Iterate& it, const Direction& step,
               const HeldRows& held, const Gap& gap) const;

  double gamma() const { return gamma_; }
  void set_gamma(double gamma) { gamma_ = gamma; }

 private:
  double add_slope_of_gap(const Iterate& now, const Direction& step, const Gap& gap, double& q);

  // More would follow the volume too closely, less would lose descent; raised as needed.
  static constexpr double smallest_gamma = 0.1;
  Evaluator& evaluator_;
  double gamma_ = smallest_gamma;
  std::vector<Vec3> reaction_;  // multipliers of prescribed coordinates that are under way [N]
  std::vector<Vec3> node_work_, inertia_;
  std::vector<double> row_work_;
};

}  // namespace isochor
