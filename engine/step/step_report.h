// What a step tells its host: counters of the solves in it, and sentences about what failed.
#pragma once

#include "engine/scene/builder.h"
#include "engine/solve/saddle_point.h"
#include "isochor/reports.h"

namespace isochor {

// Counts the work of a solve in; residuals are those of the last one.
void add_solve(StepReport& total, const SaddleReport& solve);

// "no equilibrium found at t = ...: why".
std::string failure_text(const SaddleReport& solve, double t, const std::vector<BodyData>& bodies);

StepReport invalid_step(std::string reason, double time);

}  // namespace isochor
