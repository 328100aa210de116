// What drives a scene at a time: loads, targets of rows, given multipliers, given positions. All memory is
// taken once.
#pragma once

#include "engine/scene/amounts.h"
#include "engine/solve/saddle_point.h"
#include "engine/system/state.h"

namespace isochor {

class IncrementData {
 public:
  // `weight` is the mass that gravity acts on, one a node [kg]. Gravity and the forces of the state are
  // looked at again and again: both outlive this.
  IncrementData(const System& system, const Gravity& gravity, const State& state, std::vector<double> weight);

  // Fills the arrays for time t, but those of where an increment begins.
  void evaluate(const System& system, double t);
  // The problem of an increment without inertia that begins at the state and ends at t; the arrays are those
  // of t then.
  SaddleProblem problem(const System& system, const State& state, double t);

  Vec3 gravity(double t) const { return gravity_.at(t); }
  std::span<const double> weight() const { return weight_; }
  std::span<const double> target() const { return target_; }
  std::span<const double> prescribed() const { return prescribed_; }

 private:
  const Gravity& gravity_;
  const State& state_;
  std::vector<double> weight_;               // [kg]
  std::vector<Vec3> force_;                  // dead loads [N]
  std::vector<double> target_, prescribed_;  // of compliant rows; multipliers of prescribed ones
  std::vector<double> prescribed_before_;    // the same where the increment begins
  std::vector<Vec3> position_;               // one for each System::free_bases() entry [m]
};

}  // namespace isochor
