#include "page_surface.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace isochor {

namespace {

// Faces of a tetrahedron seen from outside, with the mid-edge nodes of edges (01)(12)(20) of the face.
struct TetFace {
  std::array<int, 3> corner;
  std::array<int, 3> middle;
};
constexpr TetFace triangle_face = {{0, 1, 2}, {}};
constexpr std::array<TetFace, 4> tet_faces = {{
    {{0, 2, 1}, {6, 5, 4}},
    {{0, 1, 3}, {4, 8, 7}},
    {{1, 2, 3}, {5, 9, 8}},
    {{0, 3, 2}, {7, 9, 6}},
}};

// The eight tetrahedra of a ten-node one: four at the corners, four around the diagonal (mid 02, mid 13).
constexpr std::array<std::array<int, 4>, 8> tet10_split = {{
    {0, 4, 6, 7},
    {4, 1, 5, 8},
    {6, 5, 2, 9},
    {7, 8, 9, 3},
    {6, 4, 5, 8},
    {6, 5, 9, 8},
    {6, 9, 7, 8},
    {6, 7, 4, 8},
}};

// Faces of a hexahedron seen from outside, and a way to cut it into tetrahedra around one diagonal.
constexpr std::array<std::array<int, 4>, 6> hex_faces = {{
    {0, 4, 7, 3},
    {1, 2, 6, 5},
    {0, 1, 5, 4},
    {3, 7, 6, 2},
    {0, 3, 2, 1},
    {4, 5, 6, 7},
}};
constexpr std::array<std::array<int, 4>, 6> hex_split = {{
    {0, 1, 2, 6},
    {0, 2, 3, 6},
    {0, 3, 7, 6},
    {0, 7, 4, 6},
    {0, 4, 5, 6},
    {0, 5, 1, 6},
}};

struct Face {
  std::array<Index, 4>
      key;  // sorted corners (-1 before those of a triangle): both sides of an inner face agree
  Index cell;
  int side;
};

std::vector<Face> boundary_faces(const Mesh& mesh) {
  const std::size_t stride = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  std::vector<Face> all;
  all.reserve(static_cast<std::size_t>(mesh.cell_count()) * 4);
  for (Index cell = 0; cell < mesh.cell_count(); ++cell) {
    const Index* nodes = &mesh.cells[static_cast<std::size_t>(cell) * stride];
    const bool hexahedral = mesh.cell_type == CellType::hex8;
    const bool thin = mesh.cell_type == CellType::tri3;
    for (int side = 0; side < (hexahedral ? 6 : (thin ? 1 : 4)); ++side) {
      std::array<Index, 4> key = {-1, -1, -1, -1};
      if (hexahedral) {
        const auto& c = hex_faces[static_cast<std::size_t>(side)];
        for (std::size_t k = 0; k < 4; ++k) key[k] = nodes[c[k]];
      } else {
        const auto& c = (thin ? triangle_face : tet_faces[static_cast<std::size_t>(side)]).corner;
        for (std::size_t k = 0; k < 3; ++k) key[k] = nodes[c[k]];
      }
      std::sort(key.begin(), key.end());
      all.push_back({key, cell, side});
    }
  }
  // Sorted rather than hashed: the same mesh gives the same page on every machine.
  std::stable_sort(all.begin(), all.end(), [](const Face& a, const Face& b) { return a.key < b.key; });
  std::vector<Face> out;
  for (std::size_t i = 0; i < all.size();) {
    std::size_t next = i + 1;
    while (next < all.size() && all[next].key == all[i].key) ++next;
    if (next == i + 1) out.push_back(all[i]);
    i = next;
  }
  return out;
}

// Numbers mesh nodes in the order in which they are first used.
class Vertices {
 public:
  Vertices(PageScene& scene, const Mesh& mesh) : scene_(scene), mesh_(mesh), vertex_(mesh.nodes.size(), -1) {}

  Index of(Index node) {
    Index& vertex = vertex_[static_cast<std::size_t>(node)];
    if (vertex < 0) {
      vertex = static_cast<Index>(scene_.rest.size());
      scene_.rest.push_back(mesh_.nodes[static_cast<std::size_t>(node)]);
      nodes_.push_back(node);
    }
    return vertex;
  }
  std::vector<Index> take() { return std::move(nodes_); }

 private:
  PageScene& scene_;
  const Mesh& mesh_;
  std::vector<Index> vertex_;
  std::vector<Index> nodes_;
};

}  // namespace

std::vector<Index> add_page_mesh(PageScene& scene, const Mesh& mesh, const PagePart& part,
                                 const PageMeshOptions& options) {
  const auto part_index = static_cast<Index>(scene.parts.size());
  scene.parts.push_back(part);
  // Triangles added by hand before carry no part and no edges yet.
  scene.triangle_part.resize(scene.triangles.size() / 3, 0);
  scene.triangle_edges.resize(scene.triangles.size() / 3, 7);

  Vertices vertices(scene, mesh);
  const auto triangle = [&](Index a, Index b, Index c, std::uint8_t edges) {
    for (const Index node : {a, b, c}) scene.triangles.push_back(vertices.of(node));
    scene.triangle_part.push_back(part_index);
    scene.triangle_edges.push_back(edges);
  };
  const bool quadratic = mesh.cell_type == CellType::tet10, hexahedral = mesh.cell_type == CellType::hex8,
             thin = mesh.cell_type == CellType::tri3;
  const std::size_t stride = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  const auto owned = [&](Index cell, std::size_t from) {
    if (options.triangle_cell)
      options.triangle_cell->insert(options.triangle_cell->end(), scene.triangles.size() / 3 - from, cell);
  };
  for (const Face& face : boundary_faces(mesh)) {
    const std::size_t before = scene.triangles.size() / 3;
    const Index* nodes = &mesh.cells[static_cast<std::size_t>(face.cell) * stride];
    if (hexahedral) {
      const auto& c = hex_faces[static_cast<std::size_t>(face.side)];
      // The diagonal is no mesh edge.
      triangle(nodes[c[0]], nodes[c[1]], nodes[c[2]], 0b011);
      triangle(nodes[c[0]], nodes[c[2]], nodes[c[3]], 0b110);
      owned(face.cell, before);
      continue;
    }
    const TetFace& local = thin ? triangle_face : tet_faces[static_cast<std::size_t>(face.side)];
    const auto corner = [&](std::size_t k) { return nodes[local.corner[k]]; };
    const auto middle = [&](std::size_t k) { return nodes[local.middle[k]]; };
    if (!quadratic) {
      triangle(corner(0), corner(1), corner(2), 7);
      owned(face.cell, before);
      continue;
    }
    // Bit k stands for the edge that leaves corner k: the edges between mid nodes are no mesh edges.
    triangle(corner(0), middle(0), middle(2), 0b101);
    triangle(corner(1), middle(1), middle(0), 0b101);
    triangle(corner(2), middle(2), middle(1), 0b101);
    triangle(middle(0), middle(1), middle(2), 0);
    owned(face.cell, before);
  }

  if (options.cells && !thin) {
    for (Index cell = 0; cell < mesh.cell_count(); ++cell) {
      const Index* nodes = &mesh.cells[static_cast<std::size_t>(cell) * stride];
      const auto put = [&](const auto& local) {
        for (const int k : local) scene.cells.push_back(vertices.of(nodes[k]));
      };
      if (hexahedral) {
        for (const auto& piece : hex_split) put(piece);
      } else if (quadratic) {
        for (const auto& piece : tet10_split) put(piece);
      } else {
        put(std::array<int, 4>{0, 1, 2, 3});
      }
    }
  }
  return vertices.take();
}

}  // namespace isochor
