// The boundary of a volume mesh as triangles.
#pragma once

#include "isochor/mesh.h"
#include "isochor/solids.h"

namespace isochor {

// Faces of cells that no other cell shares, cut into triangles; corners only.
TriangleSurface boundary_of(const Mesh& mesh);

}  // namespace isochor
