// Rows whose multipliers are unknowns of the matrix: [K, G^T; G, -C].
#pragma once

#include "engine/solve/kkt/scaled_unknowns.h"

namespace isochor {

class KeptRows {
 public:
  explicit KeptRows(const System& system) : system_(system) {}

  // On top of Assembly::kkt_values(): tangents of laws in their places, and a row held at a bound leaves the
  // system, with a diagonal that keeps the inertia.
  void assemble(const MatrixValues& values, std::span<double> matrix) const;
  // Once the matrix is scaled: a trace of compliance, relative to what the rows do in it, the squares of
  // their entries over a unit diagonal. `work` is as long as the unknowns.
  void add_trace(double trace, std::span<double> matrix, std::span<double> work) const;

  void reduce(std::span<const double> row_rhs, std::span<const double> scale, std::span<double> rhs) const;
  void recover(std::span<const double> solution, std::span<const double> scale,
               std::span<double> dlambda) const;

 private:
  const System& system_;
};

}  // namespace isochor
