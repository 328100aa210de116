#include "isochor/generate.h"

#include <map>

#include "engine/base/available_memory.h"
#include "engine/base/base.h"
#include "engine/base/text.h"
#include "engine/mesh/cell_shape.h"

namespace isochor {

namespace {

constexpr int kEdge[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
constexpr int kFaceEdge[3][2] = {{0, 1}, {1, 2}, {2, 0}};

// The six Kuhn tets of a cube whose corners are numbered by bits x + 2 y + 4 z.
constexpr int kKuhn[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                             {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};

// Cells of a box, and their outer sides under the names of box_mesh.
template <class NodeNumber>
void add_hexahedra(Mesh& mesh, const std::array<Index, 3>& count, const NodeNumber& number) {
  mesh.cell_type = CellType::hex8;
  // The sides of a cell come in the order x0, x1, y0, y1, z0, z1.
  for (Index k = 0; k < count[2]; ++k) {
    for (Index j = 0; j < count[1]; ++j) {
      for (Index i = 0; i < count[0]; ++i) {
        Index n[8];
        for (std::size_t a = 0; a < 8; ++a) {
          const auto& s = kHexSign[a];
          n[a] = number(i + (s[0] + 1) / 2, j + (s[1] + 1) / 2, k + (s[2] + 1) / 2);
        }
        mesh.cells.insert(mesh.cells.end(), n, n + 8);
        const Index cell[3] = {i, j, k};
        for (std::size_t side = 0; side < 6; ++side) {
          const Index border = side % 2 == 0 ? 0 : count[side / 2] - 1;
          if (cell[side / 2] != border) continue;
          for (const std::size_t corner : kHexShape.side[side])
            mesh.surfaces[side].faces.push_back(n[corner]);
        }
      }
    }
  }
}

// A flat box: a sheet of rectangles, each cut along the diagonal that leaves a checkerboard, so that no
// direction is preferred. Its upper side looks along the axis that it has no extent in.
Result<Mesh> sheet_mesh(const BoxMeshDef& def) {
  int flat = -1, count = 0;
  for (int k = 0; k < 3; ++k) {
    if (def.upper[k] != def.lower[k]) continue;
    flat = k;
    ++count;
  }
  if (count != 1) {
    return Error{"box mesh: of triangles it is a sheet, and " +
                 (count == 0 ? std::string("no axis has") : std::to_string(count) + " axes have") +
                 " the same lower and upper corner; let exactly one"};
  }
  const int first = (flat + 1) % 3, second = (flat + 2) % 3;
  const auto along = [&](int axis) {
    return static_cast<Index>(def.divisions[static_cast<std::size_t>(axis)]);
  };
  const Index n = along(first), m = along(second);
  Mesh mesh;
  mesh.cell_type = CellType::tri3;
  mesh.source = "box";
  mesh.regions = {"body"};
  for (Index j = 0; j <= m; ++j) {
    for (Index i = 0; i <= n; ++i) {
      Vec3 x = def.lower;
      if (i > 0) x[first] = i == n ? def.upper[first] : x[first] + (def.upper[first] - x[first]) * i / n;
      if (j > 0) x[second] = j == m ? def.upper[second] : x[second] + (def.upper[second] - x[second]) * j / m;
      mesh.nodes.push_back(x);
    }
  }
  for (const int axis : {first, second}) {
    for (const int end : {0, 1}) {
      MeshNodeSet side;
      side.name = {"xyz"[axis], "01"[end]};
      for (Index k = 0; k <= (axis == first ? m : n); ++k)
        side.nodes.push_back(axis == first ? end * n + (n + 1) * k : k + (n + 1) * end * m);
      mesh.node_sets.push_back(std::move(side));
    }
  }
  for (Index j = 0; j < m; ++j) {
    for (Index i = 0; i < n; ++i) {
      const Index a = i + (n + 1) * j, b = a + 1, c = b + n + 1, d = a + n + 1;
      const Index one[6] = {a, b, c, a, c, d}, other[6] = {a, b, d, b, c, d};
      const auto& cut = (i + j) % 2 == 0 ? one : other;
      mesh.cells.insert(mesh.cells.end(), cut, cut + 6);
    }
  }
  return mesh;
}

}  // namespace

Result<Mesh> box_mesh(const BoxMeshDef& def) {
  for (int i = 0; i < 3; ++i) {
    const int n = def.divisions[static_cast<std::size_t>(i)];
    if (n < 1 || n > 1000) {
      return Error{"box mesh: divisions[" + std::to_string(i) + "] = " + std::to_string(n) +
                   "; give a number from 1 to 1000"};
    }
    const bool may_be_flat = def.cell_type == CellType::tri3 && def.upper[i] == def.lower[i];
    if (!may_be_flat && !(def.upper[i] > def.lower[i])) {
      return Error{"box mesh: upper corner must exceed the lower one in every direction, axis " +
                   std::to_string(i) + " runs from " + number(def.lower[i]) + " to " + number(def.upper[i])};
    }
  }
  if (def.cell_type == CellType::tri3) return sheet_mesh(def);
  const Index nx = def.divisions[0], ny = def.divisions[1], nz = def.divisions[2];
  const double cells = static_cast<double>(nx) * ny * nz * (def.cell_type == CellType::hex8 ? 1 : 6);
  if (const auto why = too_large_for_memory(cells, def.cell_type, MeshUse::check); !why.empty()) {
    return Error{"box mesh of " + std::to_string(nx) + " x " + std::to_string(ny) + " x " +
                     std::to_string(nz) + " divisions: " + why,
                 ErrorKind::no_memory};
  }
  if (static_cast<std::int64_t>(nx) * ny * nz > 20'000'000) {
    return Error{"box mesh: " + std::to_string(static_cast<std::int64_t>(nx) * ny * nz) +
                 " divisions are more than the 20 million this generator makes; use fewer divisions"};
  }
  Mesh mesh;
  mesh.source = "box";
  mesh.regions = {"body"};
  const auto id = [&](Index i, Index j, Index k) { return i + (nx + 1) * (j + (ny + 1) * k); };
  const auto coordinate = [](double a, double b, Index i, Index n) {
    return i == n ? b : a + (b - a) * static_cast<double>(i) / static_cast<double>(n);
  };
  for (Index k = 0; k <= nz; ++k) {
    for (Index j = 0; j <= ny; ++j) {
      for (Index i = 0; i <= nx; ++i) {
        mesh.nodes.push_back({coordinate(def.lower.x, def.upper.x, i, nx),
                              coordinate(def.lower.y, def.upper.y, j, ny),
                              coordinate(def.lower.z, def.upper.z, k, nz)});
      }
    }
  }
  mesh.surfaces = {{"x0", {}}, {"x1", {}}, {"y0", {}}, {"y1", {}}, {"z0", {}}, {"z1", {}}};
  if (def.cell_type == CellType::hex8) {
    add_hexahedra(mesh, {nx, ny, nz}, id);
    return mesh;
  }
  for (Index k = 0; k < nz; ++k) {
    for (Index j = 0; j < ny; ++j) {
      for (Index i = 0; i < nx; ++i) {
        for (const auto& tet : kKuhn) {
          Index n[4];
          for (int a = 0; a < 4; ++a) {
            n[a] = id(i + (tet[a] & 1), j + ((tet[a] >> 1) & 1), k + ((tet[a] >> 2) & 1));
          }
          mesh.cells.insert(mesh.cells.end(), n, n + 4);
          for (int skip = 0; skip < 4; ++skip) {
            for (int side = 0; side < 6; ++side) {
              const int axis = side / 2, want = side % 2;
              const Index at_border = want == 0 ? 0 : def.divisions[static_cast<std::size_t>(axis)] - 1;
              const Index cell[3] = {i, j, k};
              if (cell[axis] != at_border) continue;
              bool on = true;
              for (int a = 0; a < 4; ++a) {
                if (a != skip && ((tet[a] >> axis) & 1) != want) on = false;
              }
              if (!on) continue;
              auto& faces = mesh.surfaces[static_cast<std::size_t>(side)].faces;
              for (int a = 0; a < 4; ++a) {
                if (a != skip) faces.push_back(n[a]);
              }
            }
          }
        }
      }
    }
  }
  return def.cell_type == CellType::tet10 ? to_tet10(mesh) : mesh;
}

Mesh to_tet10(const Mesh& mesh) {
  if (mesh.cell_type != CellType::tet4) return mesh;
  Mesh out = mesh;
  out.cell_type = CellType::tet10;
  out.cells.clear();
  out.node_label.clear();
  std::map<std::pair<Index, Index>, Index> middle;
  const auto mid = [&](Index a, Index b) {
    const auto key = a < b ? std::pair(a, b) : std::pair(b, a);
    const auto [it, fresh] = middle.try_emplace(key, static_cast<Index>(out.nodes.size()));
    if (fresh) out.nodes.push_back(0.5 * (out.nodes[at(a)] + out.nodes[at(b)]));
    return it->second;
  };
  for (std::size_t c = 0; c < mesh.cells.size(); c += 4) {
    const Index* n = mesh.cells.data() + c;
    out.cells.insert(out.cells.end(), n, n + 4);
    for (const auto& [a, b] : kEdge) out.cells.push_back(mid(n[a], n[b]));
  }
  for (MeshSurface& surface : out.surfaces) {
    std::vector<Index> faces;
    for (std::size_t f = 0; f + 2 < surface.faces.size(); f += 3) {
      const Index* n = surface.faces.data() + f;
      faces.insert(faces.end(), n, n + 3);
      for (const auto& [a, b] : kFaceEdge) faces.push_back(mid(n[a], n[b]));
    }
    surface.faces = std::move(faces);
  }
  // Mid-edge nodes join a node set when both their ends are in it.
  for (MeshNodeSet& set : out.node_sets) {
    std::vector<bool> in(out.nodes.size(), false);
    for (const Index i : set.nodes) in[at(i)] = true;
    for (const auto& [ends, node] : middle) {
      if (in[at(ends.first)] && in[at(ends.second)]) set.nodes.push_back(node);
    }
  }
  for (MeshField& field : out.fields) {
    const std::size_t per = static_cast<std::size_t>(field.components);
    field.values.resize(out.nodes.size() * per);
    for (const auto& [ends, node] : middle) {
      for (std::size_t k = 0; k < per; ++k) {
        field.values[at(node) * per + k] =
            0.5 * (field.values[at(ends.first) * per + k] + field.values[at(ends.second) * per + k]);
      }
    }
  }
  return out;
}

}  // namespace isochor
