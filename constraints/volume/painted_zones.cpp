// Weights of zones in cells from fields painted on the surface.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <queue>

#include "engine/base/base.h"
#include "engine/base/text.h"
#include "engine/mesh/cell_shape.h"
#include "isochor/painted.h"

namespace isochor {

namespace {

Result<const MeshField*> find_field(const Mesh& mesh, const std::string& name) {
  const auto it = std::find_if(mesh.fields.begin(), mesh.fields.end(),
                               [&](const MeshField& f) { return f.name == name; });
  if (it != mesh.fields.end() && it->components == 1) return &*it;
  std::string known;
  for (const MeshField& f : mesh.fields)
    known += (known.empty() ? "\"" : ", \"") + f.name + "\" (" + std::to_string(f.components) + ")";
  return Error{"the mesh has no field \"" + name + "\" of one component; it has " +
               (known.empty() ? "none; paint one into the file ($NodeData of Gmsh, point data of VTK)"
                              : known + " (components)")};
}

Result<void> check_weights(const Mesh& mesh, const MeshField& field, const SurfaceFeet& feet) {
  for (const SurfaceFoot& foot : feet.cell) {
    for (const Index n : foot.node) {
      const double w = field.values[at(n)];
      if (w >= 0 && w <= 1) continue;
      const std::int64_t label = mesh.node_label.empty() ? n + 1 : mesh.node_label[at(n)];
      char number[40];
      std::snprintf(number, sizeof number, "%.6g", w);
      return Error{"field \"" + field.name + "\" is " + number + " at node " + std::to_string(label) +
                   "; painted weights lie between 0 and 1 (divide them by their largest)"};
    }
  }
  return {};
}

// Neighbors of every cell across its faces, and the centers of cells.
struct Adjacency {
  std::vector<std::vector<Index>> next;
  std::vector<Vec3> center;
};

Adjacency adjacency(const Mesh& mesh) {
  const CellShape& shape = cell_shape(mesh.cell_type);
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  Adjacency out{std::vector<std::vector<Index>>(at(mesh.cell_count())),
                std::vector<Vec3>(at(mesh.cell_count()))};
  std::map<std::vector<Index>, Index> open;
  for (Index c = 0; c < mesh.cell_count(); ++c) {
    for (std::size_t k = 0; k < shape.corners; ++k) {
      out.center[at(c)] +=
          (1.0 / static_cast<double>(shape.corners)) * mesh.nodes[at(mesh.cells[at(c) * per + k])];
    }
    for (std::size_t s = 0; s < shape.sides; ++s) {
      std::vector<Index> side;
      for (std::size_t k = 0; k < shape.side_corners; ++k)
        side.push_back(mesh.cells[at(c) * per + shape.side[s][k]]);
      std::sort(side.begin(), side.end());
      const auto [it, fresh] = open.emplace(std::move(side), c);
      if (fresh) continue;
      out.next[at(c)].push_back(it->second);
      out.next[at(it->second)].push_back(c);
    }
  }
  return out;
}

// For every cell the painted one it is nearest to, from center to center (Dijkstra); -1 where no way leads.
std::vector<Index> nearest_painted(const Mesh& mesh, const std::vector<bool>& painted) {
  const Adjacency a = adjacency(mesh);
  std::vector<double> distance(painted.size(), std::numeric_limits<double>::infinity());
  std::vector<Index> source(painted.size(), -1);
  using Entry = std::pair<double, Index>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (std::size_t c = 0; c < painted.size(); ++c) {
    if (!painted[c]) continue;
    distance[c] = 0;
    source[c] = static_cast<Index>(c);
    queue.emplace(0.0, static_cast<Index>(c));
  }
  while (!queue.empty()) {
    const auto [d, c] = queue.top();
    queue.pop();
    if (d > distance[at(c)]) continue;
    for (const Index n : a.next[at(c)]) {
      const Vec3 step = a.center[at(n)] - a.center[at(c)];
      const double there = d + std::sqrt(dot(step, step));
      if (there >= distance[at(n)]) continue;
      distance[at(n)] = there;
      source[at(n)] = source[at(c)];
      queue.emplace(there, n);
    }
  }
  return source;
}

}  // namespace

Result<PaintedCells> painted_cells(const Mesh& mesh, std::span<const std::string> fields,
                                   std::span<const std::string> surfaces, UnpaintedCells unpainted,
                                   double threshold) {
  if (fields.empty()) return Error{"no field is named; name at least one"};
  if (!(threshold >= 0 && threshold < 1)) {
    return Error{"threshold = " + number(threshold) + "; it must be at least 0 and below 1"};
  }
  auto feet = surface_feet(mesh, surfaces);
  if (!feet) return feet.failure();
  const std::size_t cells = at(mesh.cell_count());
  PaintedCells out;
  out.lost = feet.value().lost;
  for (const std::string& name : fields) {
    auto found = find_field(mesh, name);
    if (!found) return found.failure();
    const MeshField& field = *found.value();
    if (auto r = check_weights(mesh, field, feet.value()); !r) return r.failure();
    std::vector<double> weight(cells, 0);
    for (std::size_t c = 0; c < cells; ++c) {
      const SurfaceFoot& foot = feet.value().cell[c];
      for (std::size_t k = 0; k < 3; ++k) weight[c] += foot.weight[k] * field.values[at(foot.node[k])];
      if (weight[c] < threshold || weight[c] == 0) weight[c] = 0;
    }
    out.weight.push_back(std::move(weight));
  }
  std::vector<bool> painted(cells, false);
  for (std::size_t c = 0; c < cells; ++c) {
    double sum = 0;
    int count = 0;
    for (const auto& w : out.weight) {
      sum += w[c];
      count += w[c] > 0;
    }
    painted[c] = count > 0;
    out.painted += count > 0;
    out.shared += count > 1;
    for (auto& w : out.weight) w[c] /= std::max(1.0, sum);
  }
  out.without = static_cast<Index>(cells) - out.painted;
  if (unpainted == UnpaintedCells::none || out.without == 0) return out;
  const std::vector<Index> source = nearest_painted(mesh, painted);
  for (std::size_t c = 0; c < cells; ++c) {
    if (painted[c] || source[c] < 0) continue;
    for (auto& w : out.weight) w[c] = w[at(source[c])];
    ++out.filled;
    --out.without;
  }
  return out;
}

}  // namespace isochor
