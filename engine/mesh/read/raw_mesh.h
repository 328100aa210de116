// What a reader collects from a file, in the file's own terms, and how it becomes a Mesh.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/mesh/read/cursor.h"
#include "isochor/mesh.h"

namespace isochor::mesh_files {

// Mid-edge nodes of a file's ten-node tetrahedron: entry k is the place in the file's order (0 to 9) of our
// node k.
using Tet10Order = std::array<int, 10>;
inline constexpr Tet10Order vtk_tet10{0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
inline constexpr Tet10Order gmsh_tet10{0, 1, 2, 3, 4, 5, 6, 7, 9, 8};
inline constexpr Tet10Order tetgen_tet10{0, 1, 2, 3, 6, 7, 9, 5, 8, 4};

inline constexpr std::int64_t no_tag = INT64_MIN;

struct RawSurface {
  int width = 0;  // nodes a face: 3 or 6, 4 for quadrangles
  std::vector<Index> faces;
};

struct RawMesh {
  std::string file;
  std::vector<Vec3> nodes;
  std::vector<std::int64_t> node_label;
  int cell_width = 0;  // 4, 8 or 10, 0 while there is no cell
  std::vector<Index> cells;
  std::vector<std::int64_t> cell_label;
  std::vector<std::int64_t> cell_tag;  // region number in the file, or no_tag

  std::map<std::int64_t, std::string> region_name, surface_name;  // names that the file gives to numbers
  std::map<std::int64_t, RawSurface> surfaces;                    // of triangles
  std::map<std::int64_t, RawSurface> quadrangles;
  std::vector<Index> loose_triangles;  // three corners each, of no number: cells where those are triangles
  std::map<std::pair<int, std::int64_t>, MeshNodeSet> node_sets;  // by dimension and number
  std::vector<MeshField> fields;
  std::vector<MeshField> cell_fields;  // of vectors, in the cells so far; shorter where a part lacks them

  std::map<std::string, std::int64_t> foreign_cells;  // volume cells of no kind that is read, by type
  std::int64_t foreign_faces = 0;                     // faces that no cell can have (polygons, ...)
  std::int64_t flat_cells = 0;   // faces, edges and points seen, for the message when there is no volume cell
  std::int64_t stray_lines = 0;  // outside of the sections of the file
  std::int64_t shared_cells = 0;  // cells in more than one region
  std::vector<std::int64_t> shared_examples;

  // A tetrahedron with 4 or 10 nodes in the file's order, or a hexahedron with 8. Refuses mixtures.
  void add_cell(const Cursor& at, std::int64_t label, std::int64_t tag, std::span<const Index> file_nodes,
                const Tet10Order& order);
  void add_face(const Cursor& at, std::int64_t tag, std::span<const Index> corners_first);
};

// Turns numbers of a file into indices; a table while the numbers are dense, a sorted list otherwise.
class LabelMap {
 public:
  // False, and the number, if one occurs twice.
  std::pair<bool, std::int64_t> build(std::span<const std::int64_t> labels);
  Index find(std::int64_t label) const;  // -1: no such number

 private:
  std::int64_t first_ = 0;
  std::vector<Index> table_;
  std::vector<std::pair<std::int64_t, Index>> sorted_;
};

// Orders mid-edge nodes, turns inverted cells over, names regions, drops unused nodes, scales.
Mesh assemble(RawMesh raw, double scale);

}  // namespace isochor::mesh_files
