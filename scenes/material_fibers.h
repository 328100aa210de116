// The fibers of a material.
#pragma once

#include "scenes/scene.h"

namespace isochor {

// With the directions that the mesh has for them. Errors: what the mesh lacks.
Result<std::vector<FiberFamily>> fibers_of(const MaterialDef& def, const Mesh* mesh);

}  // namespace isochor
