// The stages of check_mesh and what they share.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/mesh/cell_shape.h"
#include "engine/mesh/tet_shape.h"
#include "engine/mesh/words.h"
#include "isochor/mesh_io.h"

namespace isochor::mesh_files {

// Collects what one check finds; keeps the first few numbers.
class Tally {
 public:
  void add(std::int64_t label) {
    if (++count_ <= most) examples_.push_back(label);
  }
  std::int64_t count() const { return count_; }
  // "3 cells (12, 40, 77)"; `numbered` says what the numbers are where the counted things have none of their
  // own.
  std::string text(const char* singular, const char* plural, const char* numbered = "") const;
  // Files the finding if there is one: text() + " " + message.
  void report(MeshReport& report, Severity severity, const char* code, const char* singular,
              const char* plural, const std::string& message, const char* numbered = "") const;

 private:
  static constexpr std::int64_t most = 8;
  std::int64_t count_ = 0;
  std::vector<std::int64_t> examples_;
};

inline std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}
std::int64_t cell_label(const Mesh& mesh, Index cell);
std::int64_t node_label(const Mesh& mesh, Index node);

// Disjoint sets with path halving.
class Groups {
 public:
  explicit Groups(std::size_t count);
  Index root(Index i);
  void join(Index a, Index b);

 private:
  std::vector<Index> parent_;
};

// Three corners, or four; the last of a triangle is -1.
using FaceCorners = std::array<Index, 4>;

// A face of a cell: sorted corners to compare, and where it comes from.
struct CellFace {
  FaceCorners corners{};  // ascending, so -1 comes first for a triangle
  Index cell = 0;
  std::int8_t local = 0;  // which side of the cell
  std::int8_t odd = 0;    // whether, from the smallest corner on, it runs to the larger neighbor first
  friend bool operator<(const CellFace& a, const CellFace& b) {
    return a.corners != b.corners ? a.corners < b.corners : a.cell < b.cell;
  }
};
std::vector<CellFace> sorted_cell_faces(const Mesh& mesh);

// Corners of a face, seen from outside of its cell.
FaceCorners outward_corners(const Mesh& mesh, const CellFace& face);

// Appends the nodes of a face as MeshSurface has them, wound outward.
void append_face(const Mesh& mesh, const CellFace& face, std::vector<Index>& nodes);

// Arrays of the right length, indices in range, finite numbers. Nothing else may run on a mesh that fails
// here.
bool check_arrays(const Mesh& mesh, MeshReport& report);
// Volumes, quality, tangled Tet10 and Hex8, duplicates, regions.
void check_cells(const Mesh& mesh, MeshReport& report);
// The same of a mesh of triangles: shapes, and how they hang together.
void check_triangles(const Mesh& mesh, MeshReport& report);
void check_sheet(const Mesh& mesh, MeshReport& report);
// Box, units, coincident and unused nodes, parts.
void check_nodes(const Mesh& mesh, MeshReport& report);
// Faces between cells, the boundary and its cavities.
void check_boundary(const Mesh& mesh, const std::vector<CellFace>& faces, MeshReport& report);
// Named surfaces and node sets.
void check_named_sets(const Mesh& mesh, const std::vector<CellFace>& faces, MeshReport& report);

}  // namespace isochor::mesh_files
