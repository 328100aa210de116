// Bodies as a scene says them: made, and what they have beyond a mesh (lattices around surfaces, numbers cell
// by cell).
#pragma once

#include <span>

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

// A body with its mesh read and its materials made; messages start with `where`. How it moves at the start is
// left to who adds it. A mesh that is `given` takes the place of the body's own.
struct MadeBody {
  BodyDef def;
  DisplaySurface surface;     // of a lattice
  std::vector<Index> parent;  // of each cell that of the mesh before it was refined; empty: it was not
};
Result<MadeBody> make_body(const SceneBody& body, const std::string& folder, const std::string& where,
                           const Mesh* given = nullptr);

// The numbers of a field, in place or from a file: one a cell of the mesh.
Result<std::vector<double>> read_field(const CellField& field, const std::string& folder);

// The material with its numbers cell by cell handed down to the cells of a refined mesh, given the cell that
// each of these is of; empty: as it is.
Result<MaterialDef> refined_numbers(const MaterialDef& def, const std::string& folder,
                                    std::span<const Index> parent);

}  // namespace isochor
