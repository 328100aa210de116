#include "constraints/stencil/surface_nodes.h"

#include <algorithm>
#include <map>
#include <set>

#include "constraints/stencil/face_pool.h"
#include "engine/mesh/cell_shape.h"

namespace isochor {

namespace {

// A face of six nodes as triangles.
constexpr std::size_t kParts[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};

// Mid-edge nodes of a side of a Tet10 follow its corners as (01)(12)(20).
Index middle_of(const Index* cell, std::size_t a, std::size_t b) {
  for (std::size_t e = 0; e < kTetShape.edges; ++e) {
    const auto& [i, j] = kTetShape.edge[e];
    if ((i == a && j == b) || (i == b && j == a)) return cell[4 + e];
  }
  return -1;
}

std::vector<Index> boundary_faces(const BodyData& body) {
  const CellShape& shape = cell_shape(body.mesh.cell_type);
  const auto per = static_cast<std::size_t>(nodes_per_cell(body.mesh.cell_type));
  struct Side {
    std::size_t cell = 0, side = 0;
    int count = 0;
  };
  std::map<std::array<Index, 4>, Side> sides;
  for (std::size_t c = 0; c * per < body.global_cells.size(); ++c) {
    const Index* cell = body.global_cells.data() + c * per;
    for (std::size_t s = 0; s < shape.sides; ++s) {
      std::array<Index, 4> key{-1, -1, -1, -1};
      for (std::size_t k = 0; k < shape.side_corners; ++k) key[k] = cell[shape.side[s][k]];
      std::sort(key.begin(), key.end());
      Side& found = sides[key];
      if (found.count++ == 0) found = {c, s, 1};
    }
  }
  std::vector<Index> faces;
  for (const auto& [key, side] : sides) {
    if (side.count != 1) continue;
    const Index* cell = body.global_cells.data() + side.cell * per;
    const auto& corner = shape.side[side.side];
    for (std::size_t k = 0; k < shape.side_corners; ++k) faces.push_back(cell[corner[k]]);
    if (body.mesh.cell_type != CellType::tet10) continue;
    for (std::size_t k = 0; k < 3; ++k) faces.push_back(middle_of(cell, corner[k], corner[(k + 1) % 3]));
  }
  return faces;
}

}  // namespace

Result<std::vector<Index>> surface_faces(const Builder& builder, BodyId id,
                                         std::span<const std::string> surfaces, const std::string& who) {
  if (!surfaces.empty()) return builder.faces(id, surfaces, who);
  if (!builder.has_body(id)) {
    return Error{who + ": " + builder.no_body(id)};
  }
  return boundary_faces(builder.body(id));
}

Result<std::vector<Index>> outward_faces(const Builder& builder, BodyId id,
                                         std::span<const std::string> surfaces, const std::string& who) {
  auto named = surface_faces(builder, id, surfaces, who);
  if (!named) return named.failure();
  const BodyData& body = builder.body(id);
  const auto per = static_cast<std::size_t>(nodes_per_face(body.mesh.cell_type));
  const std::vector<Index> boundary = boundary_faces(body);
  // Named faces may be wound either way, those of the boundary are not.
  const auto key = [per](std::span<const Index> face) {
    std::array<Index, 4> k{-1, -1, -1, -1};
    std::copy_n(face.begin(), per == 4 ? 4 : 3, k.begin());
    std::sort(k.begin(), k.end());
    return k;
  };
  std::set<std::array<Index, 4>> wanted;
  for (std::size_t f = 0; f < named.value().size(); f += per)
    wanted.insert(key(std::span(named.value()).subspan(f, per)));
  std::vector<Index> faces;
  for (std::size_t f = 0; f < boundary.size(); f += per) {
    const auto face = std::span(boundary).subspan(f, per);
    if (wanted.erase(key(face)) > 0) faces.insert(faces.end(), face.begin(), face.end());
  }
  if (wanted.empty()) return faces;
  return Error{who + ": " + std::to_string(wanted.size()) +
               " faces of its surfaces are inside the body; name surfaces of the boundary"};
}

std::vector<SurfaceNode> surface_nodes(std::span<const Index> faces, std::size_t per,
                                       std::span<const Vec3> rest) {
  std::map<Index, double> area;
  const auto add = [&](std::span<const Index> face) {
    for (const auto& [node, share] : nodal_areas(face, rest)) area[node] += share;
  };
  for (std::size_t f = 0; f < faces.size(); f += per) {
    const auto face = faces.subspan(f, per);
    if (per != 6) {
      add(face);
      continue;
    }
    for (const auto& part : kParts) {
      const Index corners[3] = {face[part[0]], face[part[1]], face[part[2]]};
      add(corners);
    }
  }
  std::vector<SurfaceNode> nodes;
  for (const auto& [node, share] : area) nodes.push_back({node, share});
  return nodes;
}

}  // namespace isochor
