// Checks of nodes: box and units, coincident and unused nodes, loose parts.
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "engine/mesh/check/check_parts.h"

namespace isochor::mesh_files {

namespace {

void check_box(const Mesh& mesh, MeshReport& report) {
  Vec3 low = mesh.nodes[0], high = mesh.nodes[0];
  for (const Vec3& x : mesh.nodes) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], x[k]);
      high[k] = std::max(high[k], x[k]);
    }
  }
  report.box = {low, high};
  const Vec3 size = high - low;
  const double diagonal = length(size);
  constexpr double largest = 50, smallest = 1e-3;  // [m]
  if (diagonal >= smallest && diagonal <= largest) return;
  const std::string box = join("the box is ", size.x, " x ", size.y, " x ", size.z, " m; ");
  const char* remedy = diagonal > largest
                           ? "if the file is in millimeters, read it with scale 0.001"
                           : "if a scale was applied twice, leave it out or read with scale 1000";
  report.findings.push_back({Severity::warning, "units", box + remedy, 1, {}});
}

// Nodes closer than a 1e-7th of the box, found with a grid of wider cells.
class Grid {
 public:
  Grid(const Mesh& mesh, double tolerance, const Vec3& low)
      : mesh_(mesh), tolerance_(tolerance), low_(low), next_(mesh.nodes.size(), -1) {
    head_.reserve(mesh.nodes.size());
  }

  // An earlier node in the same place, or -1; then remembers this one.
  Index find_or_add(Index node) {
    const Vec3& x = mesh_.nodes[at(node)];
    Index found = -1;
    for (int corner = 0; corner < 8 && found < 0; ++corner) {
      Vec3 shifted = x;
      for (int k = 0; k < 3; ++k) shifted[k] += ((corner >> k) & 1) != 0 ? tolerance_ : -tolerance_;
      const auto entry = head_.find(key(shifted));
      for (Index other = entry == head_.end() ? -1 : entry->second; other >= 0; other = next_[at(other)]) {
        if (length(mesh_.nodes[at(other)] - x) <= tolerance_) found = other;
      }
    }
    const auto [entry, added] = head_.emplace(key(x), node);
    if (!added) {
      next_[at(node)] = entry->second;
      entry->second = node;
    }
    return found;
  }

 private:
  std::uint64_t key(const Vec3& x) const {
    std::uint64_t hash = 0;
    for (int k = 0; k < 3; ++k) {
      // At most some ten million cells a side, so the cast is safe.
      const auto place = static_cast<std::int64_t>(std::floor((x[k] - low_[k]) / (4 * tolerance_)));
      hash = (hash ^ static_cast<std::uint64_t>(place)) * 0x9E3779B97F4A7C15ull;
      hash ^= hash >> 29;
    }
    return hash;
  }

  const Mesh& mesh_;
  double tolerance_;
  Vec3 low_;
  std::unordered_map<std::uint64_t, Index> head_;
  std::vector<Index> next_;
};

void check_coincident(const Mesh& mesh, MeshReport& report) {
  const double tolerance = 1e-7 * length(report.box[1] - report.box[0]);
  if (!(tolerance > 0) || !std::isfinite(tolerance)) return;
  Grid grid(mesh, tolerance, report.box[0]);
  Tally doubled;
  for (Index n = 0; n < mesh.node_count(); ++n) {
    if (grid.find_or_add(n) >= 0) doubled.add(node_label(mesh, n));
  }
  doubled.report(
      report, Severity::warning, "duplicate-node", "node lies", "nodes lie",
      "on another node, so cells that seem to touch are not joined; merge them (in Gmsh 'Coherence Mesh') "
      "unless a gap is meant");
}

void check_parts(const Mesh& mesh, MeshReport& report) {
  const auto width = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  Groups groups(mesh.nodes.size());
  std::vector<bool> used(mesh.nodes.size(), false);
  for (std::size_t c = 0; c < mesh.cells.size(); c += width) {
    for (std::size_t k = 0; k < width; ++k) {
      used[at(mesh.cells[c + k])] = true;
      groups.join(mesh.cells[c], mesh.cells[c + k]);
    }
  }
  Tally unused;
  for (Index n = 0; n < mesh.node_count(); ++n) {
    if (!used[at(n)]) unused.add(node_label(mesh, n));
  }
  unused.report(report, Severity::error, "unreferenced-node", "node is", "nodes are",
                "used by no cell and would have neither mass nor stiffness; remove them");
  std::vector<bool> seen(mesh.nodes.size(), false);
  Tally first_cells;
  for (Index c = 0; c < mesh.cell_count(); ++c) {
    const Index root = groups.root(mesh.cells[width * at(c)]);
    if (!seen[at(root)]) first_cells.add(cell_label(mesh, c));
    seen[at(root)] = true;
  }
  report.parts = static_cast<Index>(first_cells.count());
  if (report.parts < 2) return;
  first_cells.report(report, Severity::warning, "disconnected", "part", "separate parts",
                     "share no node with each other; join them, or hold each of them", "from cell ");
}

}  // namespace

void check_nodes(const Mesh& mesh, MeshReport& report) {
  check_box(mesh, report);
  check_coincident(mesh, report);
  check_parts(mesh, report);
}

}  // namespace isochor::mesh_files
