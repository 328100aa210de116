// What a step record says of bodies and of the scene as a whole: volumes, energies, momentum, orientations.
#pragma once

#include <vector>

#include "scenes/run/run.h"

namespace isochor {

// Bodies by their names and, where a body has several, its regions as "body.region" behind it.
std::vector<VolumeMeasures> volume_parts(const BuiltScene& built);

// Fills in volumes, row residual, extremes of J, energies and momentum, and adds the gauges of orientations.
// Those of a set of nodes that has collapsed to a line are not numbers.
void record_measures(const SceneDef& scene, const BuiltScene& built, StepRecord& record);

}  // namespace isochor
