// What makes the equations of an equilibrium unsymmetric: how forces change with what pools hold on to (the
// normal force and the frame of friction), [L, l] of [H + L, G^T + l; G, -C]; and its transpose.
#pragma once

#include "engine/system/assembly.h"

namespace isochor {

class LagTerms {
 public:
  // At the last evaluation of the assembly, whose lag was renewed there.
  LagTerms(const System& system, const Assembly& assembly, std::span<const Vec3> x);

  // force += L dx + l dlambda.
  void add(std::span<const Vec3> dx, std::span<const double> dlambda, std::span<Vec3> force) const;
  // x += factor L^T way, row += factor l^T way; of one pool, or -1: of all.
  void add_transposed(double factor, std::span<const Vec3> way, std::span<Vec3> x, std::span<double> row,
                      Index pool = -1) const;

 private:
  struct Pool {
    Index pool = -1;
    std::vector<std::int64_t> offset;  // of every stencil in `block`
    std::vector<Mat3> block;           // as LagSlots
    std::vector<Vec3> column;
  };
  const System& system_;
  std::vector<Pool> pools_;
};

// How much each function of a pool is of each compliant row: adds what functions from `first_function` on
// feel to what rows feel, and the multipliers of functions that those of rows make.
void add_to_rows(const System& s, Index pool, Index first_function, std::span<const double> felt,
                 std::span<double> row);
std::vector<double> of_functions(const System& s, Index pool, std::span<const double> row);

}  // namespace isochor
