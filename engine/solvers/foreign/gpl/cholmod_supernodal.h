// CHOLMOD's supernodal L L^T, for positive definite matrices. Its module is under the GPL, so this folder is
// a target of its own that a build must ask for (ISOCHOR_WITH_CHOLMOD_SUPERNODAL).
#pragma once

#include <memory>
#include <string>

#include "engine/solvers/linear_solver.h"
#include "engine/solvers/ordering.h"

namespace isochor {

// A matrix that is not positive definite is factored as far as it is, and has one negative pivot at least:
// the report says 1, with status ok, so that it is mended as any wrong inertia is. A pattern with multiplier
// rows is refused.
std::unique_ptr<LinearSolver> make_cholmod_supernodal_solver(OrderingMethod method = OrderingMethod::best);
std::string cholmod_supernodal_version();

}  // namespace isochor
