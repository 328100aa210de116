// Fields of mean stress under gravity: against closed forms, against a reference on the same cells, and how
// rough.
#pragma once

#include <memory>
#include <vector>

#include "studies/study.h"

namespace isochor::studies {

// Runs a column that is confined at its sides and stands on z = 0, under gravity along -z. "pressure error"
// is the L2 distance of tr(sigma)/3 of cells from -rho g depth, relative; "sinking" the largest displacement
// over the height.
Result<Numbers> column_pressure(const SceneDef& scene, int threads);

// Runs a scene and compares tr(sigma)/3 of its cells with those of `reference`, which has the same cells (a
// quadratic element on them, say). "pressure error": L2, relative; "roughness" as of pressure_roughness();
// "least" and "largest" pressure [Pa]; "volume": change of the volume, relative. The reference is computed
// once.
Probe pressure_against(SceneDef reference);

}  // namespace isochor::studies
