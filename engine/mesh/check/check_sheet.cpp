// Checks of meshes of triangles: their shapes, how they hang together, and which way round they go.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/mesh/check/check_parts.h"

namespace isochor::mesh_files {

namespace {

constexpr double flat_limit = 1e-10;  // of twice the area, relative to the longest edge squared
constexpr double poor_angle_deg = 2;

// An edge of a triangle, ends ascending.
struct Side {
  std::array<Index, 2> ends{};
  Index cell = 0;
  bool up = false;  // whether its triangle goes along it from the smaller to the larger end
  friend bool operator<(const Side& a, const Side& b) {
    return a.ends != b.ends ? a.ends < b.ends : a.cell < b.cell;
  }
};

std::vector<Side> sorted_sides(const Mesh& mesh) {
  std::vector<Side> sides;
  sides.reserve(mesh.cells.size());
  for (std::size_t c = 0; c < mesh.cells.size(); c += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = mesh.cells[c + k], b = mesh.cells[c + (k + 1) % 3];
      sides.push_back({{std::min(a, b), std::max(a, b)}, static_cast<Index>(c / 3), a < b});
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

}  // namespace

void check_triangles(const Mesh& mesh, MeshReport& report) {
  Tally flat, slivers;
  report.worst_quality = 1;
  report.smallest_dihedral_deg = 180;
  for (Index c = 0; c < mesh.cell_count(); ++c) {
    Vec3 edge[3];
    double longest = 0, squares = 0, smallest = 180;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto first = 3 * at(c);
      edge[k] = mesh.nodes[at(mesh.cells[first + (k + 1) % 3])] - mesh.nodes[at(mesh.cells[first + k])];
      longest = std::max(longest, length(edge[k]));
      squares += dot(edge[k], edge[k]);
    }
    const double twice = length(cross(edge[0], edge[1]));
    for (std::size_t k = 0; k < 3; ++k) {
      const double turn = std::atan2(twice, -dot(edge[k], edge[(k + 1) % 3])) * 180 / std::numbers::pi;
      smallest = std::min(smallest, turn);
    }
    // 1 where all sides are as long as each other.
    const double quality = squares > 0 ? 2 * std::numbers::sqrt3 * twice / squares : 0;
    report.worst_quality = std::min(report.worst_quality, quality);
    report.smallest_dihedral_deg = std::min(report.smallest_dihedral_deg, smallest);
    if (!(twice > flat_limit * longest * longest))
      flat.add(cell_label(mesh, c));
    else if (smallest < poor_angle_deg)
      slivers.add(cell_label(mesh, c));
  }
  flat.report(report, Severity::error, "degenerate-cell", "triangle has", "triangles have",
              "no area; remove or remesh");
  slivers.report(
      report, Severity::warning, "sliver", "triangle is", "triangles are",
      join("narrow (angle down to ", report.smallest_dihedral_deg, " degrees); optimize the mesh"));
}

void check_sheet(const Mesh& mesh, MeshReport& report) {
  const std::vector<Side> sides = sorted_sides(mesh);
  Tally crowded, turned;
  bool closed = true;
  for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
    while (last < sides.size() && sides[last].ends == sides[first].ends) ++last;
    closed = closed && last - first == 2;
    if (last - first > 2) crowded.add(node_label(mesh, sides[first].ends[0]));
    // Neighbors that go round the same way run along their edge in opposite directions.
    if (last - first == 2 && sides[first].up == sides[first + 1].up)
      turned.add(cell_label(mesh, sides[first + 1].cell));
  }
  crowded.report(report, Severity::warning, "non-manifold-edge", "edge joins", "edges join",
                 "more than two triangles, where a shell cannot bend; give each sheet a shell of its own",
                 "at node ");
  turned.report(
      report, Severity::error, "turned-cell", "triangle goes", "triangles go",
      "round the other way than a neighbor, so that the sheet has no upper side; turn them over (in "
      "Gmsh 'Reverse mesh', in other programs 'unify normals')");
  report.boundary.push_back({{"outer", mesh.cells}, 0, false});
  for (const MeshSurface& surface : mesh.surfaces)
    report.boundary[0].taken = report.boundary[0].taken || surface.name == "outer";
  if (!closed) return;
  const Vec3 middle = 0.5 * (report.box[0] + report.box[1]);
  for (std::size_t c = 0; c < mesh.cells.size(); c += 3) {
    const auto corner = [&](std::size_t k) { return mesh.nodes[at(mesh.cells[c + k])] - middle; };
    report.boundary[0].volume += dot(cross(corner(0), corner(1)), corner(2)) / 6;
  }
}

}  // namespace isochor::mesh_files
