// What a scene file says of a body beyond a mesh: lattices around surfaces, and numbers cell by cell.
#pragma once

#include "isochor/lattice.h"
#include "isochor/solids.h"
#include "scenes/scene.h"

namespace isochor {

// `folder`: where relative paths start.
std::string path_in(const std::string& folder, const std::string& file);

// The lattice of a body, with the surface that is shown in its place.
struct LatticeBody {
  Mesh mesh;
  DisplaySurface surface;
};
Result<LatticeBody> make_lattice(const LatticeMesh& def, const std::string& folder);

// The numbers of a field, in place or from a file: one a cell of the mesh.
Result<std::vector<double>> read_field(const CellField& field, const std::string& folder);

}  // namespace isochor
