#include "support/meshes.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numeric>
#include <random>

#include "engine/mesh/cell_shape.h"

namespace test {

namespace {

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

constexpr int kEdge[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};

std::vector<Index> face_key(const Mesh& m, const Index* nodes) {
  std::vector<Index> key(nodes, nodes + isochor::cell_shape(m.cell_type).side_corners);
  std::sort(key.begin(), key.end());
  return key;
}

// Nodes of a cell's side: corners, then for Tet10 the middle nodes of its edges.
std::vector<Index> face_nodes(const Mesh& m, Index cell, std::size_t side) {
  const Index* n = m.cells.data() + at(cell) * at(nodes_per_cell(m.cell_type));
  const isochor::CellShape& shape = isochor::cell_shape(m.cell_type);
  std::vector<Index> face;
  for (std::size_t k = 0; k < shape.side_corners; ++k) face.push_back(n[shape.side[side][k]]);
  if (m.cell_type != CellType::tet10) return face;
  int corner[3];
  for (std::size_t k = 0; k < 3; ++k) corner[k] = static_cast<int>(shape.side[side][k]);
  for (int k = 0; k < 3; ++k) {
    const int p = corner[k], q = corner[(k + 1) % 3];
    for (int e = 0; e < 6; ++e) {
      if ((kEdge[e][0] == p && kEdge[e][1] == q) || (kEdge[e][0] == q && kEdge[e][1] == p)) {
        face.push_back(n[4 + e]);
      }
    }
  }
  return face;
}

// Removes nodes that no cell uses.
void compact(Mesh& m) {
  std::vector<Index> place(m.nodes.size(), -1);
  std::vector<bool> used(m.nodes.size(), false);
  for (const Index n : m.cells) used[at(n)] = true;
  std::vector<Vec3> nodes;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    place[i] = static_cast<Index>(nodes.size());
    nodes.push_back(m.nodes[i]);
  }
  m.nodes = std::move(nodes);
  for (Index& n : m.cells) n = place[at(n)];
  for (auto& s : m.surfaces) {
    for (Index& n : s.faces) n = place[at(n)];
  }
}

}  // namespace

Mesh box(std::array<int, 3> divisions, Vec3 upper, CellType type) {
  auto mesh = isochor::box_mesh({{0, 0, 0}, upper, divisions, type});
  if (!mesh) std::abort();
  return std::move(mesh).value();
}

Mesh mapped(Mesh mesh, const std::function<Vec3(const Vec3&)>& map) {
  for (Vec3& p : mesh.nodes) p = map(p);
  return mesh;
}

Vec3 wavy(const Vec3& p) {
  return {p.x + 0.05 * std::sin(2 * p.y + 0.3) + 0.02 * p.z * p.z, p.y + 0.05 * std::sin(1.7 * p.z + p.x),
          p.z + 0.04 * std::cos(2.3 * p.x) - 0.03 * p.x * p.y};
}

Mesh without_cells(const Mesh& mesh, const Vec3& lower, const Vec3& upper, const std::string& name) {
  const auto per = at(nodes_per_cell(mesh.cell_type)), per_face = at(nodes_per_face(mesh.cell_type));
  Mesh out = mesh;
  out.cells.clear();
  const std::size_t sides = isochor::cell_shape(mesh.cell_type).sides;
  const std::size_t corners = isochor::cell_shape(mesh.cell_type).corners;
  std::map<std::vector<Index>, int> removed_faces, kept_faces;
  isochor::MeshSurface surface{name, {}};
  std::vector<Index> kept;
  for (Index c = 0; c < mesh.cell_count(); ++c) {
    const Index* n = mesh.cells.data() + at(c) * per;
    Vec3 center{};
    for (std::size_t k = 0; k < corners; ++k)
      center += (1.0 / static_cast<double>(corners)) * mesh.nodes[at(n[k])];
    const bool inside = center.x > lower.x && center.y > lower.y && center.z > lower.z &&
                        center.x < upper.x && center.y < upper.y && center.z < upper.z;
    for (std::size_t f = 0; f < sides; ++f)
      ++(inside ? removed_faces : kept_faces)[face_key(mesh, face_nodes(mesh, c, f).data())];
    if (inside) continue;
    kept.push_back(c);
    out.cells.insert(out.cells.end(), n, n + per);
  }
  for (const Index c : kept) {
    for (std::size_t f = 0; f < sides; ++f) {
      const auto nodes = face_nodes(mesh, c, f);
      if (removed_faces.count(face_key(mesh, nodes.data())) == 0) continue;
      surface.faces.insert(surface.faces.end(), nodes.begin(), nodes.end());
    }
  }
  for (auto& s : out.surfaces) {
    std::vector<Index> faces;
    for (std::size_t f = 0; f < s.faces.size(); f += per_face) {
      const Index* n = s.faces.data() + f;
      if (kept_faces.count(face_key(mesh, n)) > 0) faces.insert(faces.end(), n, n + per_face);
    }
    s.faces = faces;
  }
  out.surfaces.push_back(std::move(surface));
  compact(out);
  return out;
}

Mesh hollow_box(bool open, CellType type) {
  return without_cells(box({3, 3, 3}, {3, 3, 3}, type), {1, 1, 1}, {2, 2, open ? 3.0 : 2.0}, "chamber");
}

Mesh shuffled(const Mesh& mesh, unsigned seed, std::vector<Index>& place) {
  std::mt19937 random(seed);
  place.resize(mesh.nodes.size());
  std::iota(place.begin(), place.end(), 0);
  std::shuffle(place.begin(), place.end(), random);
  Mesh out = mesh;
  for (std::size_t i = 0; i < place.size(); ++i) out.nodes[at(place[i])] = mesh.nodes[i];
  std::vector<Index> order(at(mesh.cell_count()));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), random);
  // Even permutations of the corners, with the middle nodes following their edges.
  constexpr int kTurn[4][4] = {{0, 1, 2, 3}, {1, 2, 0, 3}, {3, 0, 2, 1}, {1, 0, 3, 2}};
  const auto per = at(nodes_per_cell(mesh.cell_type));
  for (std::size_t c = 0; c < order.size(); ++c) {
    const Index* from = mesh.cells.data() + at(order[c]) * per;
    Index* to = out.cells.data() + c * per;
    const int* turn = kTurn[random() % 4];
    if (per == 8) {
      // Turned by a quarter about the axis from bottom to top, any number of times.
      const std::size_t quarter = random() % 4;
      for (std::size_t k = 0; k < 8; ++k) to[k] = place[at(from[k / 4 * 4 + (k + quarter) % 4])];
    }
    const std::size_t third = per == 3 ? random() % 3 : 0;
    for (std::size_t k = 0; per == 3 && k < 3; ++k) to[k] = place[at(from[(k + third) % 3])];
    for (int k = 0; per != 8 && per != 3 && k < 4; ++k) to[k] = place[at(from[turn[k]])];
    for (int e = 0; per == 10 && e < 6; ++e) {
      for (int f = 0; f < 6; ++f) {
        const int p = turn[kEdge[e][0]], q = turn[kEdge[e][1]];
        if ((kEdge[f][0] == p && kEdge[f][1] == q) || (kEdge[f][0] == q && kEdge[f][1] == p)) {
          to[4 + e] = place[at(from[4 + f])];
        }
      }
    }
    if (!mesh.cell_region.empty()) out.cell_region[c] = mesh.cell_region[at(order[c])];
  }
  for (auto& s : out.surfaces) {
    for (Index& n : s.faces) n = place[at(n)];
  }
  for (auto& s : out.node_sets) {
    for (Index& n : s.nodes) n = place[at(n)];
  }
  return out;
}

Mesh divided(Mesh mesh, double x) {
  mesh.regions = {"low", "high"};
  mesh.cell_region.clear();
  const auto per = at(nodes_per_cell(mesh.cell_type));
  for (std::size_t c = 0; c < mesh.cells.size(); c += per) {
    double center = 0;
    const std::size_t corners = per == 8 ? 8 : 4;
    for (std::size_t k = 0; k < corners; ++k)
      center += mesh.nodes[at(mesh.cells[c + k])].x / static_cast<double>(corners);
    mesh.cell_region.push_back(center < x ? 0 : 1);
  }
  return mesh;
}

double corner_volume(const Mesh& mesh, std::span<const Vec3> x) {
  const auto per = at(nodes_per_cell(mesh.cell_type));
  double volume = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); c += per) {
    const Vec3 o = x[at(mesh.cells[c])];
    volume +=
        dot(x[at(mesh.cells[c + 1])] - o, cross(x[at(mesh.cells[c + 2])] - o, x[at(mesh.cells[c + 3])] - o)) /
        6;
  }
  return volume;
}

}  // namespace test
