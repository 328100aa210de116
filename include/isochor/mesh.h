// A mesh as plain data: what readers produce, scenes build and World::add_body takes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "isochor/types.h"

namespace isochor {

// Node orders are those of VTK: Tet10 has its mid-edge nodes on (01)(12)(20)(03)(13)(23); Hex8 has its
// corners counterclockwise around the bottom, then those above them. A mesh of Tri3 is that of a thin body:
// its cells are triangles in space, which all go round the same way as seen from one side.
enum class CellType : std::uint8_t { tet4, tet10, hex8, tri3 };

constexpr int nodes_per_cell(CellType type) {
  constexpr int nodes[] = {4, 10, 8, 3};
  return nodes[static_cast<int>(type)];
}
// Faces of a Tet10 carry their mid-edge nodes after the corners: (01)(12)(20). Those of a Hex8 have their
// four corners in turn. The only face of a Tri3 is the cell itself.
constexpr int nodes_per_face(CellType type) {
  constexpr int nodes[] = {3, 6, 4, 3};
  return nodes[static_cast<int>(type)];
}

// A named set of faces. The node order of a face need not say which side is outside.
struct MeshSurface {
  std::string name;
  std::vector<Index> faces;  // nodes_per_face(cell_type) node indices a face
};

struct MeshNodeSet {
  std::string name;
  std::vector<Index> nodes;
};

// Values at nodes, or in cells, that came with a file (painted weights, for example).
struct MeshField {
  std::string name;
  int components = 1;
  std::vector<double> values;  // components a node or cell
};

// What a reader changed or left out on the way in; check_mesh passes it on as a finding.
struct MeshNote {
  std::string code;     // stable name, such as "turned-cell"
  std::string message;  // one sentence with count, numbers and remedy
  std::int64_t count = 0;
  std::vector<std::int64_t> examples;  // the first few node or cell numbers, as in the file
};

struct Mesh {
  CellType cell_type = CellType::tet4;
  std::vector<Vec3> nodes;         // rest positions [m]
  std::vector<Index> cells;        // nodes_per_cell(cell_type) node indices a cell, positively oriented
  std::vector<Index> cell_region;  // index into regions, one a cell; empty: all cells are in region 0
  std::vector<std::string> regions;
  std::vector<MeshSurface> surfaces;
  std::vector<MeshNodeSet> node_sets;
  std::vector<MeshField> fields;
  std::vector<std::int64_t> node_label;  // numbers in the file, for messages; empty: index + 1
  std::vector<std::int64_t> cell_label;
  std::string source;  // file name, for messages
  std::vector<MeshNote> notes;
  std::vector<MeshField> cell_fields;  // values in cells (directions of fibers): components a cell

  Index node_count() const { return static_cast<Index>(nodes.size()); }
  Index cell_count() const {
    return static_cast<Index>(cells.size() / static_cast<std::size_t>(nodes_per_cell(cell_type)));
  }
};

}  // namespace isochor
