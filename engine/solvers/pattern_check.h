// What every backend asks of its input.
#pragma once

#include <span>
#include <string>

#include "engine/solvers/linear_solver.h"

namespace isochor {

// What is wrong with a pattern, in one sentence; empty when nothing is.
std::string check(const SymmetricPattern& pattern);
// Infinity norm of a symmetric matrix, or of one given by two triangles; NaN when a value is not finite.
// `row_sum` has one entry a row.
double matrix_norm(const SymmetricPattern& pattern, std::span<const double> values,
                   std::span<double> row_sum);

}  // namespace isochor
