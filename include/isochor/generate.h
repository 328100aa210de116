// Small generators for structured meshes, used by scenes and tests.
#pragma once

#include <array>
#include <span>

#include "isochor/export.h"
#include "isochor/mesh.h"

namespace isochor {

// A box of nx * ny * nz hexahedra, or of as many cells cut into six tets each (Kuhn), all diagonals parallel.
// Surfaces "x0", "x1", "y0", "y1", "z0", "z1" are its sides; its one region is "body". Of triangles a sheet
// that is flat along one axis, cut into a checkerboard, its upper side along that axis; its sides are node
// sets.
struct BoxMeshDef {
  Vec3 lower{0, 0, 0}, upper{1, 1, 1};  // [m]
  std::array<int, 3> divisions{1, 1, 1};
  CellType cell_type = CellType::tet4;
};
ISOCHOR_API Result<Mesh> box_mesh(const BoxMeshDef& def);

// A Tet10 mesh on the same corners, with straight edges. Meshes that are not Tet4 are returned as they are.
ISOCHOR_API Mesh to_tet10(const Mesh& mesh);

// Every cell cut into eight of its own kind (triangles into four), `levels` times; the children of cell c are
// 8 c to 8 c + 7 (4 c to 4 c + 3).
// Curved edges are followed. Regions, surfaces, node sets and fields are kept: a new node belongs to a set
// when all nodes that it lies between do, and lies on the surface of the body where the whole set does;
// fields at nodes are interpolated, those in cells and regions handed down. Tets are cut along their shortest
// inner diagonal.
ISOCHOR_API Result<Mesh> refine_mesh(const Mesh& mesh, int levels = 1);

struct RefinedMesh {
  Mesh mesh;
  std::vector<Index> parent;  // of each cell, a cell of the mesh before
};
// The cells with these numbers cut into eight (triangles into four), neighbors into as few as makes all fit
// together: tets and triangles are bisected at their longest edges, in an order that is one for the whole
// mesh. What is kept is as above. Repeated, it leaves a bounded number of shapes in practice (no bound is
// proven). Errors: hexahedra, cells that there are not, arrays that contradict each other, more than memory
// holds.
ISOCHOR_API Result<RefinedMesh> refine_cells(const Mesh& mesh, std::span<const Index> cells);

}  // namespace isochor
