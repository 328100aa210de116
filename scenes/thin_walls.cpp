#include "scenes/thin_walls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "engine/base/base.h"
#include "engine/mesh/cell_shape.h"

namespace isochor {

namespace {

// Cosine of the angle within which a support holds a side along its normal.
constexpr double kAlong = 0.9;

struct Side {
  std::array<Index, 3> sorted{}, corner{};
};

// Sides that one cell alone has, with their corners counterclockwise seen from outside.
std::vector<Side> surface_of(const Mesh& mesh) {
  std::vector<Side> all, surface;
  all.reserve(mesh.cells.size());
  for (std::size_t c = 0; c + 4 <= mesh.cells.size(); c += 4) {
    for (const auto& side : kTetShape.side) {
      Side s;
      for (std::size_t k = 0; k < 3; ++k) s.corner[k] = mesh.cells[c + side[k]];
      s.sorted = s.corner;
      std::sort(s.sorted.begin(), s.sorted.end());
      all.push_back(s);
    }
  }
  std::sort(all.begin(), all.end(), [](const Side& a, const Side& b) { return a.sorted < b.sorted; });
  for (std::size_t i = 0, end = 0; i < all.size(); i = end) {
    for (end = i + 1; end < all.size() && all[end].sorted == all[i].sorted;) ++end;
    if (end == i + 1) surface.push_back(all[i]);
  }
  return surface;
}

void add_named(const Mesh& mesh, const std::string& name, std::vector<bool>& held) {
  for (const MeshSurface& s : mesh.surfaces) {
    if (s.name != name) continue;
    for (const Index i : s.faces) held[at(i)] = true;
    return;
  }
  // Surfaces that every body has, such as "outer".
  MeshSelection whole;
  whole.of = {name};
  const auto faces = select_faces(mesh, whole);
  for (std::size_t k = 0; faces && k < faces.value().size(); ++k) held[at(faces.value()[k])] = true;
}

// Nodes that a support names; single points count for nothing here.
std::vector<bool> nodes_of(const Mesh& mesh, const Selection& where) {
  std::vector<bool> held(mesh.nodes.size(), where.everything);
  for (const std::string& name : where.surfaces) add_named(mesh, name, held);
  for (const MeshNodeSet& set : mesh.node_sets) {
    if (std::find(where.node_sets.begin(), where.node_sets.end(), set.name) == where.node_sets.end())
      continue;
    for (const Index i : set.nodes) held[at(i)] = true;
  }
  for (std::size_t c = 0; c < mesh.cell_region.size(); ++c) {
    const std::string& region = mesh.regions[at(mesh.cell_region[c])];
    if (std::find(where.regions.begin(), where.regions.end(), region) == where.regions.end()) continue;
    for (std::size_t k = 0; k < 4; ++k) held[at(mesh.cells[4 * c + k])] = true;
  }
  for (const Index i : where.nodes) {
    if (i >= 0 && i < mesh.node_count()) held[at(i)] = true;
  }
  for (const auto& [lower, upper] : where.boxes) {
    for (std::size_t i = 0; i < held.size(); ++i) {
      const Vec3& x = mesh.nodes[i];
      held[i] = held[i] || (x.x >= lower.x && x.y >= lower.y && x.z >= lower.z && x.x <= upper.x &&
                            x.y <= upper.y && x.z <= upper.z);
    }
  }
  return held;
}

bool holds_along(const DirichletDef& support, const Vec3& normal) {
  if (support.directions.empty() || support.directions.size() > 2) return true;
  return std::any_of(support.directions.begin(), support.directions.end(),
                     [&](const Vec3& d) { return std::abs(dot(direction(d), normal)) > kAlong; });
}

std::string share_text(double share) {
  char text[16];
  std::snprintf(text, sizeof text, "%.0f %%", 100 * share);
  return text;
}

}  // namespace

double share_without_inside(const Mesh& mesh, const std::vector<DirichletDef>& supports) {
  if (mesh.cell_type != CellType::tet4) return 0;
  std::vector<std::vector<bool>> held;
  for (const DirichletDef& s : supports) held.push_back(nodes_of(mesh, s.where));
  std::vector<bool> outside(mesh.nodes.size(), false);
  for (const Side& side : surface_of(mesh)) {
    const auto x = [&](std::size_t k) { return mesh.nodes[at(side.corner[k])]; };
    const Vec3 normal = direction(cross(x(1) - x(0), x(2) - x(0)));
    bool free = true;
    for (std::size_t s = 0; s < supports.size() && free; ++s) {
      const bool all =
          std::all_of(side.corner.begin(), side.corner.end(), [&](Index i) { return held[s][at(i)]; });
      free = !(all && holds_along(supports[s], normal));
    }
    for (const Index i : side.corner) outside[at(i)] = outside[at(i)] || free;
  }
  double without = 0, total = 0;
  for (std::size_t c = 0; c + 4 <= mesh.cells.size(); c += 4) {
    const Index* n = mesh.cells.data() + c;
    const auto x = [&](std::size_t k) { return mesh.nodes[at(n[k])]; };
    const double volume = std::abs(dot(cross(x(1) - x(0), x(2) - x(0)), x(3) - x(0)));
    total += volume;
    if (std::all_of(n, n + 4, [&](Index i) { return outside[at(i)]; })) without += volume;
  }
  return total > 0 ? without / total : 0;
}

std::vector<std::string> thin_walls(const SceneDef& scene, const BuiltScene& built) {
  std::vector<std::string> out;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    if (body.element != Element::tet4 && body.element != Element::tet4_edge_smoothed) continue;
    std::vector<DirichletDef> supports;
    for (const DirichletDef& s : scene.dirichlet) {
      if (at(static_cast<Index>(s.where.body)) == b) supports.push_back(s);
    }
    const double share = share_without_inside(built.world.mesh(built.bodies[b]), supports);
    if (!(share > kThinWallShare)) continue;
    out.push_back(
        "body \"" + body.name + "\": " + share_text(share) +
        " of its volume is in elements without a node inside the body: walls with fewer than two elements "
        "across, where Tet4, edge-smoothed too, bend too stiffly; take \"element\": \"tet10\", or "
        "\"refine\": 1, or let `isochor run --error` find what it takes");
  }
  return out;
}

std::string thin_walls(const Mesh& mesh) {
  const double share = share_without_inside(mesh);
  if (!(share > kThinWallShare)) return {};
  return share_text(share) +
         " of the volume is in cells without a node inside the body: walls with fewer than two cells across, "
         "where Tet4, "
         "edge-smoothed too, bend too stiffly; take Tet10 or a finer mesh, unless supports hold both sides "
         "of the layer";
}

}  // namespace isochor
