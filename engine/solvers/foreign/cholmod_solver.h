// CHOLMOD's simplicial LDL^T, without pivoting. Its supernodal module, which is GPL, is never asked for.
#pragma once

#include <memory>
#include <string>

#include "engine/solvers/linear_solver.h"
#include "engine/solvers/ordering.h"

namespace isochor {

// Null when CHOLMOD is not part of this build.
std::unique_ptr<LinearSolver> make_cholmod_solver(OrderingMethod method = OrderingMethod::best);
std::string cholmod_version();  // empty when not built in

}  // namespace isochor
