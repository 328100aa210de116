#include "constraints/chamber/chamber_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "engine/mesh/cell_shape.h"

namespace isochor {

namespace {

// Ascending; the first of a triangle is -1.
using FaceKey = std::array<Index, 4>;

FaceKey sorted_corners(std::span<const Index> corners) {
  FaceKey key{-1, -1, -1, -1};
  std::copy(corners.begin(), corners.end(), key.begin());
  std::sort(key.begin(), key.end());
  return key;
}
FaceKey key_of(const ChamberFace& f) {
  return sorted_corners(std::span(f).first(corners_of(f)));
}

void flip(ChamberFace& f) {
  std::swap(f[1], f[corners_of(f) - 1]);
  if (f.size() == 6) std::swap(f[3], f[5]);
}

}  // namespace

Result<void> orient_faces(const BodyData& body, std::vector<ChamberFace>& faces, std::span<const Vec3> rest,
                          const std::string& who) {
  const auto per = static_cast<std::size_t>(nodes_per_cell(body.mesh.cell_type));
  const CellShape& shape = cell_shape(body.mesh.cell_type);
  struct Owner {
    int cells = 0;
    Vec3 middle{};  // of the last cell
  };
  std::map<FaceKey, Owner> owners;
  for (const ChamberFace& f : faces) owners[key_of(f)] = {};
  for (std::size_t c = 0; c < body.global_cells.size(); c += per) {
    const Index* n = body.global_cells.data() + c;
    for (std::size_t side = 0; side < shape.sides; ++side) {
      std::array<Index, 4> corner{};
      for (std::size_t k = 0; k < shape.side_corners; ++k) corner[k] = n[shape.side[side][k]];
      const auto it = owners.find(sorted_corners(std::span(corner).first(shape.side_corners)));
      if (it == owners.end()) continue;
      ++it->second.cells;
      it->second.middle = {};
      for (std::size_t k = 0; k < shape.corners; ++k)
        it->second.middle += (1.0 / static_cast<double>(shape.corners)) * rest[at(n[k])];
    }
  }
  for (ChamberFace& f : faces) {
    const auto& [count, middle] = owners[key_of(f)];
    if (count != 1) {
      return Error{who + "face (" + std::to_string(f[0] - body.first_node + 1) + ", " +
                   std::to_string(f[1] - body.first_node + 1) + ", " +
                   std::to_string(f[2] - body.first_node + 1) + ") belongs to " + std::to_string(count) +
                   " cells; a cavity is bounded by faces of exactly one cell, name boundary surfaces only"};
    }
    // From the diagonals, where there are two.
    const std::size_t last = corners_of(f) - 1;
    const Vec3 a = rest[at(f[0])];
    const Vec3 normal = cross(rest[at(f[last - 1])] - a, rest[at(f[last])] - rest[at(f[last == 3 ? 1 : 0])]);
    if (dot(normal, middle - a) < 0) flip(f);
  }
  return {};
}

Result<void> orient_sheet(const BodyData& body, std::vector<ChamberFace>& faces, std::span<const Vec3> rest,
                          const std::string& who) {
  Vec3 middle{};
  for (const ChamberFace& f : faces) {
    for (const Index n : f) middle += (1.0 / static_cast<double>(3 * faces.size())) * rest[at(n)];
  }
  double volume = 0, size = 0;
  for (const ChamberFace& f : faces) {
    const double cone = dot(cross(rest[at(f[0])] - middle, rest[at(f[1])] - middle), rest[at(f[2])] - middle);
    volume += cone;
    size += std::abs(cone);
  }
  if (!(std::abs(volume) > 1e-6 * size)) {
    return Error{
        who + "the faces of the thin body \"" + body.name +
        "\" are flat or as much bent one way as the other, so that it is not known which side of them "
        "the chamber is on; close the surface"};
  }
  if (volume < 0)
    for (ChamberFace& f : faces) flip(f);
  return {};
}

Result<std::vector<std::vector<Index>>> boundary_loops(const std::vector<ChamberFace>& faces,
                                                       const std::string& who) {
  struct Edge {
    int forward = 0, backward = 0;  // faces that run along it from the smaller node on, and against that
    Index middle = -1;
  };
  std::map<std::pair<Index, Index>, Edge> edges;
  for (const ChamberFace& f : faces) {
    for (std::size_t k = 0; k < corners_of(f); ++k) {
      const Index a = f[k], b = f[(k + 1) % corners_of(f)];
      Edge& edge = edges[std::minmax(a, b)];
      ++(a < b ? edge.forward : edge.backward);
      if (f.size() == 6) edge.middle = f[3 + k];
    }
  }
  std::map<Index, std::pair<Index, Index>> next;  // corner -> (next corner, mid)
  for (const auto& [ends, edge] : edges) {
    const int open = edge.forward - edge.backward;
    if (open == 0) continue;
    // The hole's loop runs against the faces.
    const Index from = open > 0 ? ends.second : ends.first, to = open > 0 ? ends.first : ends.second;
    if (std::abs(open) > 1 || !next.emplace(from, std::pair(to, edge.middle)).second) {
      return Error{who +
                   "two of its openings touch in one node; separate them in the mesh, or add the faces "
                   "between them to the cavity"};
    }
  }
  std::vector<std::vector<Index>> loops;
  while (!next.empty()) {
    std::vector<Index> loop;
    Index at_node = next.begin()->first;
    while (true) {
      const auto it = next.find(at_node);
      if (it == next.end()) break;
      loop.push_back(it->first);
      if (it->second.second >= 0) loop.push_back(it->second.second);
      at_node = it->second.first;
      next.erase(it);
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace isochor
