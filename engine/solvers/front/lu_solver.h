// Eigen's sparse LU for matrices that are symmetric in their pattern alone: the one that every build has.
#pragma once

#include <memory>

#include "engine/solvers/linear_solver.h"
#include "engine/solvers/ordering.h"

namespace isochor {

// As make_unsymmetric_solver() of linear_solver.h describes.
std::unique_ptr<LinearSolver> make_eigen_lu_solver(OrderingMethod method = OrderingMethod::best);

}  // namespace isochor
