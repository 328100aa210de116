// Cells cut into smaller ones of their own kind: what all ways of refining share.
//
// 1. A template says which points the children of a cell have, and how each follows from the nodes of the
//    parent: by its shape functions, so that curved edges are followed and nothing is left to a special case.
// 2. A point is known by the corners that it lies between, counted as often as their barycentric coordinates
//    say. Neighbors find each other's points by this, whatever the order of their nodes.
// 3. Named surfaces, node sets and fields follow from the points.
#pragma once

#include <unordered_map>

#include "engine/base/base.h"
#include "engine/mesh/cell_shape.h"

namespace isochor::refining {

// Corners that a point lies between, ascending. Of triangles and tets each stands in here as often as four
// times its barycentric coordinate; of quadrangles and hexahedra the ends of an edge twice, those of a face
// once.
using Key = std::array<Index, 4>;

struct KeyHash {
  std::size_t operator()(const Key& key) const {
    std::uint64_t h = 0;
    for (const Index i : key) h = (h ^ static_cast<std::uint64_t>(i)) * 0x9e3779b97f4a7c15ull + (h >> 29);
    return static_cast<std::size_t>(h ^ (h >> 32));
  }
};

// A point of the children: a node of the parent, or the sum of nodes of the parent by weights.
struct Point {
  int node = -1;  // of the parent; -1: a new one
  std::array<int, 4> corner{};
  bool shared = true;  // with cells that have the same corners
  std::vector<std::pair<std::size_t, double>> weights;
};

struct Template {
  std::vector<Point> points;
  std::vector<std::size_t> children;  // points, the nodes of one child after another
};

// The corners of each child, numbered as the nodes of a Tet10 of the parent, or of a triangle with the
// middles of its edges (01)(12)(20).
using TetChildren = std::vector<std::array<std::size_t, 4>>;
using TriangleChildren = std::vector<std::array<std::size_t, 3>>;
Template tet_template(bool quadratic, const TetChildren& children);
Template triangle_template(const TriangleChildren& children);  // of a cell that is a triangle

// Which children cells and faces get. Faces that cells share must get the same from all of them.
class Cuts {
 public:
  virtual ~Cuts() = default;
  virtual const Template& of(const Index* cell) const = 0;
  virtual TriangleChildren of_triangle(const Index* corners) const = 0;
};

// A mesh with every cell cut once; `parent`, where it is wanted, becomes the cell that each one is of.
Result<Mesh> cut(const Mesh& mesh, const Cuts& cuts, std::vector<Index>* parent = nullptr);

// Arrays that fit each other, as far as refining relies on it.
Result<void> check_arrays(const Mesh& mesh);

}  // namespace isochor::refining
