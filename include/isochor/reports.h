// What a step did and how it ended.
#pragma once

#include <cstdint>
#include <string>

#include "isochor/types.h"
#include "isochor/work.h"

namespace isochor {

enum class StepStatus : std::uint8_t {
  converged,
  rejected,  // no equilibrium found; the state is as it was
  cancelled,
  invalid,
  unfinished,  // the budget ran out: the state is the best iterate, the residuals say how good
};

// What had to be done to compile a scene that was new or had changed.
enum class CompileWork : std::uint8_t {
  nothing,
  numbers,    // other constants in the same structure: the next step makes new factors, as every step does
  structure,  // other nodes, stencils or rows: patterns and the ordering of the factors are new as well
};
struct CompileReport {
  CompileWork work = CompileWork::nothing;
  double seconds = 0;  // without the ordering, which the next step counts as StageSeconds::analyze
};

struct StepReport : SolveCounters {
  StepStatus status = StepStatus::converged;
  std::string reason;  // empty when converged; else one sentence
  double time = 0;     // of the state now
  int substeps = 0, rejected_substeps = 0;
  int rescues = 0;           // increments that only a damped motion brought to their equilibrium
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
  StageSeconds seconds;
  CompileReport compiled;  // of all compilations since the last step, for whichever call
};

struct ProgressInfo {
  double time = 0, target = 0;
  int iteration = 0;
  double force_residual = 0, row_residual = 0;
};

}  // namespace isochor
