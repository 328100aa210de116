// Evaluates the stencils of a system into their slots and sums the slots in fixed order. All memory is taken
// once, at construction; a call allocates nothing. Where the system is shared out over ranks, what these
// functions return is the same on all of them, but for what goes into the matrix and row_jacobian().
#pragma once

#include "engine/base/parallel.h"
#include "engine/system/system.h"

namespace isochor {

class Assembly {
 public:
  Assembly(std::shared_ptr<const System> system, const Parallel& parallel);

  const System& system() const { return *system_; }

  // The increment that evaluations belong to, and what pools keep between steps (System::memory() numbers, or
  // none: pools see no memory); both must live until the next call. {}: none.
  void set_increment(const StencilIncrement& increment, std::span<const double> memory = {}) {
    increment_ = increment;
    memory_ = memory;
    lagged_ = false;
  }
  // What pools with a lag hold on to from now on, until the next set_increment().
  void renew_lag(std::span<const Vec3> x, std::span<const double> lambda, std::span<const double> prescribed);

  // What a pool is asked for all its stencils at x, with the multipliers of the last evaluation.
  StencilRequest request(Index pool, Want want, std::span<const Vec3> x) const;

  // Evaluates all pools at x with the multipliers of compliant and prescribed rows, up to `want`.
  void evaluate(Want want, Definiteness definiteness, std::span<const Vec3> x, std::span<const double> lambda,
                std::span<const double> prescribed);
  // The same for pools with a lag alone, at the positions and multipliers of the last evaluation: what a lag
  // that was renewed since has changed.
  void evaluate_lagging(Want want, std::span<const Vec3> x);

  // The following read the last evaluation.
  double energy() const;                                    // sum over stencils [J], fixed order
  double absolute_energy() const;                           // sum of magnitudes, for rounding estimates
  void row_values(std::span<double> phi) const;             // compliant rows
  void prescribed_row_values(std::span<double> phi) const;  // prescribed rows
  void residual(std::span<Vec3> r) const;                   // per node: d(energy + lambda . phi)/dx
  void residual_magnitude(std::span<double> r) const;       // per node: sum of |contributions|
  void constraint_force(std::span<const double> lambda, std::span<Vec3> r) const;  // G^T lambda
  // y = H v over all nodes, given ones included (Want::hessian).
  void hessian_times(std::span<const Vec3> v, std::span<Vec3> y);
  // y = G v over compliant rows.
  void jacobian_times(std::span<const Vec3> v, std::span<double> y) const;

  // y = M v over all nodes.
  void mass_times(std::span<const Vec3> v, std::span<Vec3> y) const;

  // Values of the saddle-point matrix in kkt() order: [K + mass_scale M, G^T; G, -C] (Want::hessian).
  void kkt_values(double mass_scale, std::span<double> values) const;

  // Jacobian vectors of Gathers::jacobian_ends in free directions, for rows that are not in the matrix.
  void row_jacobian(std::span<Vec3> jacobian) const;

  // Multipliers of the functions of one stencil pool at the last evaluation (Want::gradient or more).
  std::span<const double> function_multipliers(Index pool) const;

  // Largest diagonal entry of each node's own block of K (Want::hessian).
  void stiffness_diagonal(std::span<double> k) const;

  std::size_t memory_bytes() const;

 private:
  void evaluate_pool(std::size_t p, Want want, Definiteness definiteness, std::span<const Vec3> x);
  void exchange(Want want);
  void gather_block(std::int64_t block, Mat3& sum) const;
  void gather_multipliers(std::span<const double> lambda, std::span<const double> prescribed,
                          std::span<double> out) const;

  std::shared_ptr<const System> system_;
  const Parallel& parallel_;
  StencilIncrement increment_;
  std::span<const double> memory_;
  bool lagged_ = false;
  std::vector<Vec3> lag_x_;
  std::vector<double> lag_multiplier_;
  std::vector<double> energy_, value_, multiplier_;
  std::vector<Vec3> gradient_, jacobian_;
  std::vector<Mat3> hessian_;
  std::vector<Vec3> product_;  // per gradient slot, for hessian_times
  // Of the last evaluation, where the system is shared out: energy, sum of magnitudes and all rows; and the
  // force on each node with the sum of its parts' magnitudes, four numbers a node.
  std::vector<double> sums_, forces_;
};

}  // namespace isochor
