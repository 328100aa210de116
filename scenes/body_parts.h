// What a scene file says of a body beyond a mesh: lattices around surfaces, and numbers cell by cell.
#pragma once

#include "isochor/lattice.h"
#include "scenes/scene.h"

namespace isochor {

// `folder`: where relative paths start.
std::string path_in(const std::string& folder, const std::string& file);

// A triangle surface from a Wavefront file (.obj), or the boundary of a volume mesh of any kind that is read.
struct TriangleSurface {
  std::vector<Vec3> points;      // [m], as in the file
  std::vector<Index> triangles;  // three points each, counterclockwise seen from outside
};
Result<TriangleSurface> read_surface(const std::string& path);
// Faces of cells that no other cell shares, cut into triangles; corners only.
TriangleSurface boundary_of(const Mesh& mesh);

// The lattice of a body, with the surface that is shown in its place.
struct LatticeBody {
  Mesh mesh;
  DisplaySurface surface;
};
Result<LatticeBody> make_lattice(const LatticeMesh& def, const std::string& folder);

// The numbers of a field, in place or from a file: one a cell of the mesh.
Result<std::vector<double>> read_field(const CellField& field, const std::string& folder);

}  // namespace isochor
