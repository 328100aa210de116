// A few rows over much of a body, eliminated around the factorization: with A the matrix without them and B
// their columns,
//   A u + B dl = f,  B^T u - C dl = g   reads   S dl = g - B^T A^-1 f,  u = A^-1 f - A^-1 B dl
// with the Schur complement S = -C - B^T A^-1 B, small and indefinite.
#pragma once

#include "engine/solve/kkt/factored_matrix.h"
#include "engine/solve/kkt/matrix_values.h"
#include "engine/solve/kkt/row_jacobian.h"

namespace isochor {

class BorderedRows {
 public:
  // `matrix` and `jacobian` outlive this.
  BorderedRows(const System& system, FactoredMatrix& matrix, const RowJacobian& jacobian);
  ~BorderedRows();

  // With the matrix factored: a solve for each row, S, and its share of the inertia in `outcome` (Haynsworth:
  // that of the whole is that of A plus that of S).
  void assemble(const MatrixValues& values, FactorOutcome& outcome);
  // Sets the right-hand sides of these rows aside; {}: zeros.
  void reduce(std::span<const double> row_rhs);
  // The matrix with its border, from FactoredMatrix::rhs() to its solution().
  // `tolerance` as LinearSolver::solve_to(), of the matrix's part; that of the border is exact.
  bool solve(StageSeconds& seconds, double tolerance = 0);
  void recover(std::span<double> dlambda) const;

 private:
  bool solve_columns(FactorOutcome& outcome);
  void invert(FactorOutcome& outcome);

  const System& system_;
  FactoredMatrix& matrix_;
  const RowJacobian& jacobian_;
  std::vector<double> solution_;  // A^-1 B, by columns
  std::vector<double> rhs_, work_, value_;
  struct SchurComplement;
  std::unique_ptr<SchurComplement> schur_;
};

}  // namespace isochor
