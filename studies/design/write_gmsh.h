// Meshes as files that scenes can name.
#pragma once

#include <string>

#include "isochor/mesh.h"

namespace isochor::design {

// Gmsh 2.2, ASCII, every bit of the coordinates; regions, surfaces and node sets as physical groups. Fields
// are left out. Written beside the target and renamed.
Result<void> write_gmsh(const std::string& path, const Mesh& mesh);

}  // namespace isochor::design
