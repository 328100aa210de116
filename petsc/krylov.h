// FGMRES on a saddle point that lies on several ranks. Its preconditioner is [B G^T; 0 -S]^-1 with a cycle of
// algebraic multigrid B on the displacements, whose coarse grids hold the rigid motions, and a diagonal S on
// the multipliers (Murphy, Golub & Wathen 2000; Benzi, Golub & Liesen 2005, 10.1).
#pragma once

#include <petscksp.h>

#include <string>

#include "petsc/shared_matrix.h"

namespace isochor {

class Krylov {
 public:
  // `matrix` (padded) and what else is referred to outlive this; `scale` as LinearSolver::set_scale().
  Krylov(const SharedMatrix& matrix, std::span<const UnknownGeometry> geometry,
         std::span<const double> scale);
  ~Krylov();
  Krylov(const Krylov&) = delete;
  Krylov& operator=(const Krylov&) = delete;

  bool usable() const { return trouble_.empty(); }
  const std::string& trouble() const { return trouble_; }
  // From matrix.right() to matrix.solution(), until the residual is `tolerance` of the right-hand side, or
  // what iterations can give.
  bool solve(double tolerance, int& iterations);

 private:
  MatNullSpace rigid_motions(std::span<const UnknownGeometry> geometry, std::span<const double> scale) const;
  void make_parts(MatNullSpace motions);
  void make_row_diagonal();
  void measure_wide_rows();

  const SharedMatrix& matrix_;
  KSP ksp_ = nullptr;
  IS displacements_ = nullptr, rows_ = nullptr;
  Mat row_diagonal_ = nullptr;  // -S
  std::string trouble_;
};

}  // namespace isochor
