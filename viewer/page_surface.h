// From a volume mesh to what the results page draws.
#pragma once

#include <vector>

#include "isochor/mesh.h"
#include "results_page.h"

namespace isochor {

struct PageMeshOptions {
  bool cells = true;  // keep the inside, so that sections show the field there (about doubles the page)
  std::vector<Index>* triangle_cell = nullptr;  // where given: the cell of each triangle added
};

// Adds the boundary of the mesh to the scene as one part, oriented outward; regions become categories only if
// the caller makes a field of them. Six-node faces become four flat triangles with their inner edges hidden.
// Returns the mesh node of each vertex added, in order: positions and fields of a frame are gathered by it.
// Call it once a body; vertices of the bodies follow one another.
std::vector<Index> add_page_mesh(PageScene& scene, const Mesh& mesh, const PagePart& part,
                                 const PageMeshOptions& options = {});

}  // namespace isochor
