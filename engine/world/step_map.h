// Time schemes as linear maps of what each node has.
#pragma once

#include <span>
#include <vector>

#include "engine/step/time_scheme.h"

namespace isochor {

// One step of a scheme as numbers, the same for all nodes. A node has lists of a vector each: its position,
// its velocity, and those that the scheme keeps.
struct StepMap {
  double mass_scale = 0;
  std::vector<double> predicted;            // where inertia carries it, by list
  std::vector<std::vector<double>> before;  // [list after][list before]
  std::vector<double> found;                // of the position that was found, by list after
};

// Of a step of length h from time t; `memory` is what the scheme keeps of all nodes.
StepMap step_map(const TimeScheme& scheme, std::span<const double> memory, double t, double h);

}  // namespace isochor
