// Random meshes: grids of blocks with holes, slivers, graded sizes, bent edges and several regions.
#pragma once

#include <string>
#include <vector>

#include "isochor/mesh.h"
#include "studies/chaos/random.h"

namespace isochor::studies {

struct ChaosMeshKind {
  CellType cell_type = CellType::tet4;
  int largest_cells = 200;
  Vec3 size{1, 1, 1};  // [m], of the block that it is cut from
  bool chamber =
      false;  // a hole inside, whose walls are the surface "chamber"; else the block may have notches
};

struct ChaosMesh {
  Mesh mesh;
  // Surfaces that exist: the sides "x0" to "z1", and "chamber" or "notch".
  std::vector<std::string> surfaces;
  bool chamber = false;
};

ChaosMesh chaos_mesh(const ChaosMeshKind& kind, ChaosRandom& random);

// The text of a Gmsh file (2.2), coordinates to the last bit.
std::string gmsh_text(const Mesh& mesh);

}  // namespace isochor::studies
