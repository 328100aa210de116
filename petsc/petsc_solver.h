// Linear systems that lie on several ranks, by PETSc: factors of MUMPS, which tell the inertia, or FGMRES
// with the upper triangle of blocks for a preconditioner, multigrid on the displacements and the row metric
// on the multipliers. Options of PETSc have the last word.
#pragma once

#include <memory>

#include "engine/solvers/linear_solver.h"
#include "isochor/ranks.h"

namespace isochor {

// Null where `kind` is none that works across ranks: automatic, mumps and iterative do.
std::unique_ptr<LinearSolver> make_petsc_solver(const Ranks& ranks, Solver kind, bool prefer_iterative);

}  // namespace isochor
