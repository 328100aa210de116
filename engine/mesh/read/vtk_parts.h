// What the two VTK readers share: cell types, cells in flat arrays, and the arrays that may name regions.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/mesh/read/cursor.h"
#include "engine/mesh/read/raw_mesh.h"

namespace isochor::mesh_files {

struct VtkArray {
  std::string name;
  int components = 1;
  std::vector<double> values;
};

// Cells as VTK keeps them: cell i has the points connectivity[offsets[i]] up to offsets[i + 1].
struct VtkCells {
  std::vector<std::int64_t> offsets{0};
  std::vector<std::int64_t> connectivity;
  std::vector<std::int64_t> types;

  std::size_t count() const { return offsets.size() - 1; }
};

// Adds all cells; points are counted from `first_node`. The integer array named "region", "gmsh:physical",
// "CellEntityIds", "MaterialIds" or alike numbers the regions and, on faces, the surfaces.
void add_vtk_cells(const Cursor& at, const VtkCells& cells, const std::vector<VtkArray>& cell_arrays,
                   Index first_node, RawMesh& raw);

// Point arrays become fields. Arrays that do not fit are refused.
void add_vtk_point_array(const Cursor& at, VtkArray array, std::size_t points, RawMesh& raw);

// Points are numbered from 0, as ParaView shows them.
void add_vtk_points(const Cursor& at, const std::vector<double>& coordinates, RawMesh& raw);

}  // namespace isochor::mesh_files
