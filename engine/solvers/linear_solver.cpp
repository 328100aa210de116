#include "engine/solvers/linear_solver.h"

#include "engine/solvers/chosen_solver.h"
#include "engine/solvers/foreign/cholmod_solver.h"
#ifdef ISOCHOR_HAVE_CHOLMOD_SUPERNODAL
#include "engine/solvers/foreign/gpl/cholmod_supernodal.h"
#endif
#include "engine/solvers/foreign/eigen_solver.h"
#include "engine/solvers/foreign/mumps_solver.h"
#include "engine/solvers/front/lu_solver.h"
#include "engine/solvers/front/multifrontal_solver.h"
#include "engine/solvers/iterative/iterative_solver.h"
#include "engine/solvers/ordering.h"

namespace isochor {

// Two threads take a third off the factor time from 10,000 unknowns on and cost nothing below. A fixed
// number, so that the last bits do not depend on how many cores there are.
constexpr int default_blas_threads = 2;

namespace {

// The best of those with pivoting, or with a cure for pivots that vanish.
std::unique_ptr<LinearSolver> make_pivoting_solver() {
  auto solver = make_mumps_solver();
  if (!solver) solver = make_cholmod_solver();
  if (!solver) solver = make_eigen_solver();
  return solver;
}

}  // namespace

std::unique_ptr<LinearSolver> make_linear_solver(Solver kind, const SolverWishes& wishes) {
  if (blas_threads() == 0) set_blas_threads(default_blas_threads);
  switch (kind) {
    case Solver::mumps:
      return make_mumps_solver();
    case Solver::cholmod:
      return make_cholmod_solver();
    case Solver::eigen:
      return make_eigen_solver();
    case Solver::iterative:
      return make_iterative_solver();
    case Solver::cholmod_supernodal:
#ifdef ISOCHOR_HAVE_CHOLMOD_SUPERNODAL
      return make_cholmod_supernodal_solver();
#else
      return nullptr;
#endif
    case Solver::multifrontal:
    case Solver::automatic:
      break;
  }
  auto direct =
      make_multifrontal_solver(make_pivoting_solver(), {.single_precision = wishes.single_precision});
  if (kind == Solver::multifrontal) return direct;
  ChoiceOptions choice;
  choice.prefer_iterative = wishes.prefer_iterative;
  return std::make_unique<ChosenSolver>(std::move(direct), make_iterative_solver(), choice);
}

std::unique_ptr<LinearSolver> make_unsymmetric_solver(Solver kind) {
  if (blas_threads() == 0) set_blas_threads(default_blas_threads);
  std::unique_ptr<LinearSolver> solver;
  if (kind == Solver::automatic || kind == Solver::multifrontal || kind == Solver::mumps) {
    MumpsOptions options;
    options.unsymmetric = true;
    solver = make_mumps_solver(options);
  }
  return solver ? std::move(solver) : make_eigen_lu_solver();
}

std::vector<SolverBackend> linear_solver_backends() {
  std::vector<SolverBackend> backends{{"multifrontal", ISOCHOR_VERSION, "Apache-2.0"}};
  if (const std::string v = mumps_version(); !v.empty()) backends.push_back({"MUMPS", v, "CeCILL-C"});
  if (const std::string v = cholmod_version(); !v.empty()) {
    // Only LGPL modules are called, but a distribution's library holds the GPL ones as well, and what a
    // binary is linked against decides its license.
    backends.push_back(
        {"CHOLMOD", v, "LGPL-2.1-or-later (simplicial); distribution builds contain GPL modules"});
  }
#ifdef ISOCHOR_HAVE_CHOLMOD_SUPERNODAL
  backends.push_back({"CHOLMOD supernodal", cholmod_supernodal_version(), "GPL-2.0-or-later"});
#endif
  backends.push_back({"Eigen", eigen_version(), "MPL-2.0"});
  if (have_metis()) backends.push_back({"METIS (ordering)", std::string(metis_version()), "Apache-2.0"});
  return backends;
}

}  // namespace isochor
