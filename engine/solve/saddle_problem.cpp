#include "engine/solve/saddle_problem.h"

#include <algorithm>
#include <cmath>

namespace isochor {

bool all_finite(const SaddleProblem& p) {
  const auto ok = [](double v) { return std::isfinite(v); };
  return std::all_of(p.force.begin(), p.force.end(), finite) &&
         std::all_of(p.position.begin(), p.position.end(), finite) &&
         std::all_of(p.target.begin(), p.target.end(), ok) &&
         std::all_of(p.prescribed.begin(), p.prescribed.end(), ok) &&
         std::all_of(p.memory.begin(), p.memory.end(), ok) && std::isfinite(p.mass_scale) &&
         (p.mass_scale == 0 || std::all_of(p.predicted.begin(), p.predicted.end(), finite));
}

std::string_view to_string(SaddleStatus status) {
  switch (status) {
    case SaddleStatus::converged:
      return "converged";
    case SaddleStatus::iteration_limit:
      return "iteration limit reached";
    case SaddleStatus::line_search_failed:
      return "line search found no descent";
    case SaddleStatus::singular:
      return "saddle-point matrix is singular";
    case SaddleStatus::diverged:
      return "positions diverged";
    case SaddleStatus::not_finite:
      return "not a finite number";
    case SaddleStatus::cancelled:
      return "cancelled";
    case SaddleStatus::out_of_memory:
      return "out of memory";
    case SaddleStatus::passed_through:
      return "nodes passed through an obstacle";
    case SaddleStatus::inadmissible:
      return "the solution is no admissible state";
  }
  return "unknown";
}

}  // namespace isochor
