// Eigen's simplicial LDL^T, without pivoting: the fallback that every build has.
#pragma once

#include <memory>
#include <string>

#include "engine/solvers/linear_solver.h"
#include "engine/solvers/ordering.h"

namespace isochor {

std::unique_ptr<LinearSolver> make_eigen_solver(OrderingMethod method = OrderingMethod::best);
std::string eigen_version();

}  // namespace isochor
