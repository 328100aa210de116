// What a step did and how it ended.
#pragma once

#include <cstdint>
#include <string>

#include "isochor/types.h"

namespace isochor {

enum class StepStatus : std::uint8_t {
  converged,
  rejected,  // no equilibrium found; the state is as it was
  cancelled,
  invalid,
  unfinished,  // the budget ran out: the state is the best iterate, the residuals say how good
};

// Seconds by stage of the work done.
struct StageTimes {
  double analyze = 0, evaluate = 0, gather = 0, factor = 0, solve = 0, line_search = 0, total = 0;
};

struct StepReport {
  StepStatus status = StepStatus::converged;
  std::string reason;  // empty when converged; else one sentence
  double time = 0;     // of the state now
  int substeps = 0, rejected_substeps = 0;
  int iterations = 0;   // Newton iterations, each with its own factorization
  int corrections = 0;  // further steps on factors at hand
  int lagged = 0;       // FrictionCoupling::coupled: iterations that fell back to lagged friction
  int factorizations = 0, trials = 0;
  int projected = 0, shifted = 0;  // iterations whose matrix had to be mended
  int dual_steps = 0;              // of dual ascent
  int stand_ins = 0;  // increments that a dual method left to Method::augmented_gradients or saddle_point
  std::int64_t dual_iterations = 0;    // of conjugate gradients on multipliers
  std::int64_t linear_iterations = 0;  // of Solver::iterative
  int rescues = 0;                     // increments that only a damped motion brought to their equilibrium
  int error_rejections = 0;  // increments that converged and were taken back for WorldOptions::time_error
  Index negative_pivots = -1, expected_negative_pivots = 0;
  // follow(): directions in which the equilibrium is unstable under fixed loads; -1: the backend cannot tell.
  Index unstable_directions = -1;
  double time_error = 0;  // estimate for the last increment, as in WorldOptions
  // Of the state now: smallest J over all cells (over points for Tet10 and Hex8), and cells with J <= 0. A
  // cell that started right side out is inverted only where its law lives through that and has no guard.
  double min_J = 1;
  Index inverted_cells = 0;
  // A sentence about an end that is admissible and yet not to be taken as it is: cells inverted or crushed,
  // an equilibrium far from the last one, rows that a fixed number of sweeps leaves unmet. Empty: none.
  std::string warning;
  double force_residual = 0, row_residual = 0, linear_residual = 0;
  StageTimes seconds;
};

struct ProgressInfo {
  double time = 0, target = 0;
  int iteration = 0;
  double force_residual = 0, row_residual = 0;
};

}  // namespace isochor
