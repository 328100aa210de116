// Rows outside the matrix whose multipliers are found by preconditioned conjugate gradients on their Schur
// complement.
//
// With A = K + G^T W G, W >= 0 a diagonal, and T = 1 - W C, the system
//   K dx + G^T dl = f,  G dx - C dl = g   reads   A dx + G^T T dl = f + G^T W g,  G dx - C dl = g.
// Its second line times T^T, with dx from the first, is symmetric,
//   T^T (C + G A^-1 G^T T) dl = T^T (G A^-1 (f + G^T W g) - g),
// and positive definite as long as A is and W C <= 1. W = 0 is the plain dual system. The solution does not
// depend on W; a large one makes A an augmented Lagrangian's Hessian, positive definite where K is not, and
// the iteration short. The preconditioner is the row metric D, in which a volume row's Schur complement is of
// order 1 on any mesh (the diagonal of the pressure's mass matrix over mu; Benzi, Golub & Liesen
// 2005, 10.1.1).
#pragma once

#include "engine/solve/kkt/bordered_rows.h"

namespace isochor {

class DualRows {
 public:
  // What is referred to outlives this. A^-1 is the matrix with its border.
  DualRows(const System& system, FactoredMatrix& matrix, BorderedRows& border, const RowJacobian& jacobian);

  // W, C and the preconditioner, and G^T W G on top of the stiffness.
  void assemble(const MatrixValues& values, std::span<double> matrix);
  // rhs += G^T W g.
  void reduce(std::span<const double> row_rhs, std::span<double> rhs) const;
  // The iteration, from the right-hand side of the matrix to its solution and the multipliers of these rows.
  bool solve(std::span<const double> row_rhs, StageSeconds& seconds);
  void recover(std::span<const double> row_rhs, std::span<double> dlambda) const;

  // For methods that iterate themselves. Weights W, one a row, for given values; then, with the matrix
  // factored: q = T^T (C + G A^-1 G^T T) p, and v becomes T^T v.
  std::span<const double> weights(const MatrixValues& values);
  bool apply(std::span<const double> p, std::span<double> q, StageSeconds& seconds);
  void weigh_transposed(std::span<double> v);
  std::span<const double> preconditioner() const { return preconditioner_; }

  std::int64_t iterations() const { return iterations_; }  // so far; each is one solve

 private:
  void weigh(std::span<const double> v, std::span<double> out) const;
  void add_compliance(double alpha, std::span<const double> v, std::span<double> y) const;
  bool start(std::span<const double> row_rhs, StageSeconds& seconds);
  void precondition();
  double dot(std::span<const double> a, std::span<const double> b) const;

  const System& system_;
  FactoredMatrix& matrix_;
  BorderedRows& border_;
  const RowJacobian& jacobian_;
  std::int64_t iterations_ = 0;
  // Over all rows of the system: 1 where a row is not held at a bound, and what else belongs to its line.
  std::vector<double> active_, weight_, preconditioner_;
  std::vector<double> compliance_;                // of TreatedRows::dual_compliance
  std::vector<double> x_, r_, z_, p_, q_, work_;  // of the iteration
  std::vector<double> rhs_;                       // of the matrix, with g in it
};

}  // namespace isochor
