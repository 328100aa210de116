#include "petsc/krylov.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "petsc/calls.h"

namespace isochor {

namespace {

constexpr double kTolerance = 1e-8;
constexpr PetscInt kMostIterations = 1000, kRestart = 100;
constexpr Index kWideRow = 1200;  // displacements; rows over more are measured
constexpr std::size_t kMostWideRows = 64;

}  // namespace

Krylov::Krylov(const SharedMatrix& matrix, std::span<const UnknownGeometry> geometry,
               std::span<const double> scale)
    : matrix_(matrix) {
  PC pc = nullptr;
  check(KSPCreate(PETSC_COMM_WORLD, &ksp_), "making FGMRES");
  check(KSPSetOperators(ksp_, matrix.matrix(), matrix.matrix()), "making FGMRES");
  check(KSPSetType(ksp_, KSPFGMRES), "making FGMRES");
  check(KSPGMRESSetRestart(ksp_, kRestart), "making FGMRES");
  check(KSPSetTolerances(ksp_, kTolerance, PETSC_DEFAULT, PETSC_DEFAULT, kMostIterations), "making FGMRES");
  check(KSPGetPC(ksp_, &pc), "making FGMRES");
  MatNullSpace motions = rigid_motions(geometry, scale);
  if (matrix.rows() > 0) {
    check(PCSetType(pc, PCFIELDSPLIT), "making FGMRES");
    make_parts(motions);
  } else {
    check(PCSetType(pc, PCGAMG), "making FGMRES");
    check(MatSetBlockSize(matrix.matrix(), 3), "making FGMRES");
    check(MatSetNearNullSpace(matrix.matrix(), motions), "making FGMRES");
  }
  check(MatNullSpaceDestroy(&motions), "making FGMRES");
  check(KSPSetFromOptions(ksp_), "making FGMRES");
  check(KSPSetUp(ksp_), "setting up FGMRES");
  PCFailedReason failed = PC_NOERROR;
  check(PCGetFailedReason(pc, &failed), "setting up FGMRES");
  if (failed != PC_NOERROR) {
    trouble_ = "no preconditioner was found for the stiffness (PETSc: PCFailedReason " +
               std::to_string(static_cast<int>(failed)) + ")";
    return;
  }
  if (matrix.rows() > 0) measure_wide_rows();
}

Krylov::~Krylov() {
  if (ksp_) KSPDestroy(&ksp_);
  if (displacements_) ISDestroy(&displacements_);
  if (rows_) ISDestroy(&rows_);
  if (row_diagonal_) MatDestroy(&row_diagonal_);
}

// In scaled unknowns, orthonormal. What all nodes together cannot do is left out.
MatNullSpace Krylov::rigid_motions(std::span<const UnknownGeometry> geometry,
                                   std::span<const double> scale) const {
  Vec3 center{}, low = geometry.front().position, high = low;
  for (const UnknownGeometry& g : geometry) {
    center += g.position;
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], g.position[i]);
      high[i] = std::max(high[i], g.position[i]);
    }
  }
  center = (1.0 / static_cast<double>(geometry.size())) * center;
  const Vec3 extent = high - low;
  const double length = std::max(std::sqrt(dot(extent, extent)), 1e-300);
  std::vector<Vec> motions;
  for (int m = 0; m < 6; ++m) {
    Vec v = nullptr;
    double* part = nullptr;
    check(VecCreateMPI(PETSC_COMM_WORLD, matrix_.displacements_here(), matrix_.displacements(), &v),
          "rigid motions");
    check(VecSetBlockSize(v, 3), "rigid motions");
    check(VecGetArray(v, &part), "rigid motions");
    for (const Index u : matrix_.own()) {
      if (at(u) >= geometry.size()) break;
      const UnknownGeometry& g = geometry[at(u)];
      const Vec3& d = g.direction;
      const Vec3 p = (1 / length) * (g.position - center);
      const Vec3 turn{p.y * d.z - p.z * d.y, p.z * d.x - p.x * d.z, p.x * d.y - p.y * d.x};
      part[matrix_.place(u) - matrix_.first_here()] =
          (m < 3 ? d[m] : turn[m - 3]) / (scale.empty() ? 1 : scale[at(u)]);
    }
    check(VecRestoreArray(v, &part), "rigid motions");
    PetscReal whole = 0, rest = 0;
    check(VecNorm(v, NORM_2, &whole), "rigid motions");
    for (Vec other : motions) {
      PetscScalar share = 0;
      check(VecDot(v, other, &share), "rigid motions");
      check(VecAXPY(v, -share, other), "rigid motions");
    }
    check(VecNorm(v, NORM_2, &rest), "rigid motions");
    if (rest > 1e-8 * whole) {
      check(VecScale(v, 1 / rest), "rigid motions");
      motions.push_back(v);
    } else {
      check(VecDestroy(&v), "rigid motions");
    }
  }
  MatNullSpace space = nullptr;
  check(MatNullSpaceCreate(PETSC_COMM_WORLD, PETSC_FALSE, static_cast<PetscInt>(motions.size()),
                           motions.data(), &space),
        "rigid motions");
  for (Vec& v : motions) check(VecDestroy(&v), "rigid motions");
  return space;
}

void Krylov::make_parts(MatNullSpace motions) {
  PC pc = nullptr;
  check(KSPGetPC(ksp_, &pc), "making FGMRES");
  check(ISCreateStride(PETSC_COMM_WORLD, matrix_.displacements_here(), matrix_.first_here(), 1,
                       &displacements_),
        "making FGMRES");
  check(ISSetBlockSize(displacements_, 3), "making FGMRES");
  check(ISCreateStride(PETSC_COMM_WORLD, matrix_.rows_here(),
                       matrix_.first_here() + matrix_.displacements_here(), 1, &rows_),
        "making FGMRES");
  check(PetscObjectCompose(reinterpret_cast<PetscObject>(displacements_), "nearnullspace",
                           reinterpret_cast<PetscObject>(motions)),
        "making FGMRES");
  check(PCFieldSplitSetIS(pc, "x", displacements_), "making FGMRES");
  check(PCFieldSplitSetIS(pc, "lambda", rows_), "making FGMRES");
  check(PCFieldSplitSetType(pc, PC_COMPOSITE_SCHUR), "making FGMRES");
  check(PCFieldSplitSetSchurFactType(pc, PC_FIELDSPLIT_SCHUR_FACT_UPPER), "making FGMRES");
  make_row_diagonal();
  check(PCFieldSplitSetSchurPre(pc, PC_FIELDSPLIT_SCHUR_PRE_USER, row_diagonal_), "making FGMRES");
}

// Rows come in units of their metric: the Schur complement G K^-1 G^T + C of those over a few cells is close
// to 1 + C, the mass matrix of a pressure for volumes.
void Krylov::make_row_diagonal() {
  Vec whole = nullptr, part = nullptr;
  check(VecDuplicate(matrix_.right(), &whole), "the row metric");
  check(MatGetDiagonal(matrix_.matrix(), whole), "the row metric");
  check(VecGetSubVector(whole, rows_, &part), "the row metric");
  Vec diagonal = nullptr;
  check(VecDuplicate(part, &diagonal), "the row metric");
  check(VecCopy(part, diagonal), "the row metric");
  check(VecAbs(diagonal), "the row metric");
  check(VecShift(diagonal, 1), "the row metric");
  check(VecScale(diagonal, -1), "the row metric");
  check(VecRestoreSubVector(whole, rows_, &part), "the row metric");
  check(VecDestroy(&whole), "the row metric");
  check(MatCreateAIJ(PETSC_COMM_WORLD, matrix_.rows_here(), matrix_.rows_here(), matrix_.rows(),
                     matrix_.rows(), 1, nullptr, 0, nullptr, &row_diagonal_),
        "the row metric");
  check(MatDiagonalSet(row_diagonal_, diagonal, INSERT_VALUES), "the row metric");
  check(VecDestroy(&diagonal), "the row metric");
}

// Rows over much of a body have no such bound, but are few: g^T B g with a cycle of the multigrid.
void Krylov::measure_wide_rows() {
  const std::vector<PetscInt> wide = matrix_.wide_rows(kWideRow, kMostWideRows);
  PC pc = nullptr;
  PetscBool split = PETSC_FALSE;
  check(KSPGetPC(ksp_, &pc), "wide rows");
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCFIELDSPLIT, &split), "wide rows");
  if (wide.empty() || !split) return;
  KSP* parts = nullptr;
  PetscInt count = 0;
  check(PCFieldSplitSchurGetSubKSP(pc, &count, &parts), "wide rows");
  Vec unit = nullptr, column = nullptr, z = nullptr, diagonal = nullptr;
  check(VecDuplicate(matrix_.right(), &unit), "wide rows");
  check(VecDuplicate(matrix_.right(), &column), "wide rows");
  check(MatCreateVecs(row_diagonal_, &diagonal, nullptr), "wide rows");
  check(MatGetDiagonal(row_diagonal_, diagonal), "wide rows");
  for (const PetscInt r : wide) {
    PetscInt first = 0, end = 0;
    check(VecGetOwnershipRange(unit, &first, &end), "wide rows");
    const bool here = r >= first && r < end;
    check(VecSet(unit, 0), "wide rows");
    if (here) check(VecSetValue(unit, r, 1, INSERT_VALUES), "wide rows");
    check(VecAssemblyBegin(unit), "wide rows");
    check(VecAssemblyEnd(unit), "wide rows");
    check(MatMult(matrix_.matrix(), unit, column), "wide rows");
    Vec g = nullptr;
    check(VecGetSubVector(column, displacements_, &g), "wide rows");
    check(VecDuplicate(g, &z), "wide rows");
    check(KSPSolve(parts[0], g, z), "wide rows");
    PetscScalar schur = 0;
    check(VecDot(g, z, &schur), "wide rows");
    check(VecRestoreSubVector(column, displacements_, &g), "wide rows");
    check(VecDestroy(&z), "wide rows");
    if (!(schur > 0) || !std::isfinite(schur)) continue;
    // What was 1 + C becomes g^T B g + C.
    if (here) {
      double* value = nullptr;
      check(VecGetArray(diagonal, &value), "wide rows");
      value[r - first - matrix_.displacements_here()] -= schur - 1;
      check(VecRestoreArray(diagonal, &value), "wide rows");
    }
  }
  check(MatDiagonalSet(row_diagonal_, diagonal, INSERT_VALUES), "wide rows");
  check(VecDestroy(&unit), "wide rows");
  check(VecDestroy(&column), "wide rows");
  check(VecDestroy(&diagonal), "wide rows");
  check(PetscFree(parts), "wide rows");
}

bool Krylov::solve(double tolerance, int& iterations) {
  PetscBool given = PETSC_FALSE;
  check(PetscOptionsHasName(nullptr, nullptr, "-ksp_rtol", &given), "solving");
  if (!given)
    check(
        KSPSetTolerances(ksp_, std::max(tolerance, kTolerance), PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT),
        "solving");
  check(KSPSolve(ksp_, matrix_.right(), matrix_.solution()), "solving");
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  PetscInt count = 0;
  check(KSPGetConvergedReason(ksp_, &reason), "solving");
  check(KSPGetIterationNumber(ksp_, &count), "solving");
  iterations += static_cast<int>(count);
  return reason > 0;
}

}  // namespace isochor
