// Checks of single cells: volume, shape, folded Tet10, duplicates, regions.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/mesh/check/check_parts.h"

namespace isochor::mesh_files {

namespace {

// |6V| below this fraction of the longest edge cubed is no volume: rounding of coordinates makes more.
constexpr double flat_limit = 1e-9;
// Below these a cell spoils the condition of the stiffness long before it is degenerate.
constexpr double poor_quality = 0.05, poor_dihedral_deg = 5;

struct Shape {
  double volume6 = 0;       // signed [m^3]
  double longest = 0;       // [m]
  double quality = 0;       // 3 r_in / r_circ: 1 for the regular tetrahedron, 0 for a flat one
  double smallest_deg = 0;  // dihedral angle
};

Shape shape_of(const std::array<Vec3, 4>& x) {
  Shape s;
  s.volume6 = volume6(x[0], x[1], x[2], x[3]);
  for (const auto& e : tet_edges) s.longest = std::max(s.longest, length(x[at(e[1])] - x[at(e[0])]));
  std::array<Vec3, 4> normal;  // twice the area long, outward
  double area2 = 0;
  for (std::size_t f = 0; f < 4; ++f) {
    const auto& [a, b, c] = tet_faces[f];
    normal[f] = cross(x[at(b)] - x[at(a)], x[at(c)] - x[at(a)]);
    area2 += length(normal[f]);
  }
  double widest_cosine = -1;
  for (std::size_t f = 0; f < 4; ++f) {
    for (std::size_t g = f + 1; g < 4; ++g) {
      const double scale = length(normal[f]) * length(normal[g]);
      const double cosine = scale > 0 ? -dot(normal[f], normal[g]) / scale : 1;
      widest_cosine = std::max(widest_cosine, cosine);
    }
  }
  s.smallest_deg = std::acos(std::clamp(widest_cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
  // r_in = 3V/A and, with p, q, r the products of opposite edges, r_circ =
  // sqrt((p+q+r)(p+q-r)(p-q+r)(q+r-p))/(24V).
  const double p = length(x[1] - x[0]) * length(x[3] - x[2]);
  const double q = length(x[2] - x[0]) * length(x[3] - x[1]);
  const double r = length(x[3] - x[0]) * length(x[2] - x[1]);
  const double root = std::sqrt(std::max(0.0, (p + q + r) * (p + q - r) * (p - q + r) * (q + r - p)));
  const double volume = std::abs(s.volume6) / 6;
  if (root > 0 && area2 > 0) s.quality = 3 * (6 * volume / area2) * (24 * volume) / root;
  return s;
}

using Barycentric = std::array<double, 4>;

// Corners, mid-edges and the four-point rule of degree 2, at which Tet10 elements are integrated.
std::array<Barycentric, 14> jacobian_points() {
  constexpr double a = 0.5854101966249685, b = 0.1381966011250105;  // (5 + 3 sqrt 5)/20, (5 - sqrt 5)/20
  std::array<Barycentric, 14> points{};
  for (std::size_t i = 0; i < 4; ++i) {
    points[i][i] = 1;
    points[4 + i].fill(b);
    points[4 + i][i] = a;
  }
  for (std::size_t e = 0; e < 6; ++e) {
    for (const int corner : tet_edges[e]) points[8 + e][at(corner)] = 0.5;
  }
  return points;
}

// det of d(position)/d(barycentric 1..3) of a quadratic tetrahedron; 6V where it is straight.
double jacobian(const std::array<Vec3, 10>& x, const Barycentric& l) {
  std::array<Vec3, 4> d{};  // derivative by each barycentric coordinate
  for (std::size_t i = 0; i < 4; ++i) d[i] = (4 * l[i] - 1) * x[i];
  for (std::size_t e = 0; e < 6; ++e) {
    const auto i = at(tet_edges[e][0]), j = at(tet_edges[e][1]);
    d[i] += 4 * l[j] * x[4 + e];
    d[j] += 4 * l[i] * x[4 + e];
  }
  return dot(cross(d[1] - d[0], d[2] - d[0]), d[3] - d[0]);
}

bool is_tangled(const Mesh& mesh, Index cell, double longest) {
  static const std::array<Barycentric, 14> points = jacobian_points();
  std::array<Vec3, 10> x;
  for (std::size_t k = 0; k < 10; ++k) x[k] = mesh.nodes[at(mesh.cells[10 * at(cell) + k])];
  const double limit = flat_limit * longest * longest * longest;
  return std::any_of(points.begin(), points.end(),
                     [&](const Barycentric& l) { return !(jacobian(x, l) > limit); });
}

// Integral of det J by the four-point rule: exact for straight cells, of third order for curved ones.
double curved_volume(const Mesh& mesh, Index cell) {
  static const std::array<Barycentric, 14> points = jacobian_points();
  std::array<Vec3, 10> x;
  for (std::size_t k = 0; k < 10; ++k) x[k] = mesh.nodes[at(mesh.cells[10 * at(cell) + k])];
  double sum = 0;
  for (std::size_t i = 4; i < 8; ++i) sum += jacobian(x, points[i]);
  return sum / 24;
}

std::array<Vec3, 3> hex_tangents(const std::array<Vec3, 8>& x, const Vec3& xi) {
  std::array<Vec3, 3> d{};
  for (std::size_t a = 0; a < 8; ++a) {
    const Vec3 g = hex_gradient(a, xi);
    for (int k = 0; k < 3; ++k) d[at(k)] += g[k] * x[a];
  }
  return d;
}

Vec3 hex_corner(std::size_t a) {
  return {1.0 * kHexSign[a][0], 1.0 * kHexSign[a][1], 1.0 * kHexSign[a][2]};
}

// The angle between the two faces that meet in the edge along `along`, the other edges there being a and b.
double dihedral_deg(const Vec3& along, const Vec3& a, const Vec3& b) {
  const Vec3 n = cross(along, a), m = cross(along, b);
  const double scale = length(n) * length(m);
  return scale > 0 ? std::acos(std::clamp(dot(n, m) / scale, -1.0, 1.0)) * 180 / std::numbers::pi : 0;
}

// A hexahedron: quality is its worst corner's Jacobian over the product of the edges there (1 for a brick).
Shape hex_shape_of(const std::array<Vec3, 8>& x, bool& tangled) {
  Shape s;
  s.quality = 1;
  s.smallest_deg = 180;
  for (const auto& [a, b] : kHexShape.edge) s.longest = std::max(s.longest, length(x[b] - x[a]));
  const double limit = flat_limit * s.longest * s.longest * s.longest;
  tangled = false;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const auto at_corner = hex_tangents(x, hex_corner(corner));
    const double j = dot(at_corner[0], cross(at_corner[1], at_corner[2]));
    const double edges = length(at_corner[0]) * length(at_corner[1]) * length(at_corner[2]);
    s.quality = std::min(s.quality, edges > 0 ? j / edges : 0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      // Edges that leave the corner, not those along the axes.
      const double turn = kHexSign[corner][(k + 1) % 3] * kHexSign[corner][(k + 2) % 3];
      s.smallest_deg = std::min(
          s.smallest_deg, dihedral_deg(at_corner[k], at_corner[(k + 1) % 3], turn * at_corner[(k + 2) % 3]));
    }
    const auto inside = hex_tangents(x, kHexGauss * hex_corner(corner));
    const double weight = dot(inside[0], cross(inside[1], inside[2]));
    s.volume6 += 6 * weight;
    tangled = tangled || !(8 * j > limit) || !(8 * weight > limit);
  }
  return s;
}

void check_shapes(const Mesh& mesh, MeshReport& report) {
  const auto width = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  const bool hexahedral = mesh.cell_type == CellType::hex8;
  const bool quadratic = mesh.cell_type == CellType::tet10;
  Tally flat, inverted, tangled, slivers;
  report.worst_quality = 1;
  report.smallest_dihedral_deg = 180;
  for (Index c = 0; c < mesh.cell_count(); ++c) {
    std::array<Vec3, 8> x{};
    for (std::size_t k = 0; k < (hexahedral ? 8 : 4); ++k)
      x[k] = mesh.nodes[at(mesh.cells[width * at(c) + k])];
    bool folded = false;
    const Shape s = hexahedral ? hex_shape_of(x, folded) : shape_of({x[0], x[1], x[2], x[3]});
    report.volume += quadratic ? curved_volume(mesh, c) : s.volume6 / 6;
    report.worst_quality = std::min(report.worst_quality, s.quality);
    report.smallest_dihedral_deg = std::min(report.smallest_dihedral_deg, s.smallest_deg);
    const double limit = flat_limit * s.longest * s.longest * s.longest;
    if (!(std::abs(s.volume6) > limit)) {
      flat.add(cell_label(mesh, c));
    } else if (s.volume6 < 0) {
      inverted.add(cell_label(mesh, c));
    } else if (folded || (quadratic && is_tangled(mesh, c, s.longest))) {
      tangled.add(cell_label(mesh, c));
    } else if (s.quality < poor_quality || s.smallest_deg < poor_dihedral_deg) {
      slivers.add(cell_label(mesh, c));
    }
  }
  flat.report(report, Severity::error, "degenerate-cell", "cell has", "cells have",
              "no volume; remove or remesh");
  inverted.report(report, Severity::error, "inverted-cell", "cell is", "cells are",
                  hexahedral ? "inverted; exchange their bottom and top corners"
                             : "inverted; exchange two corners (and the mid-edge nodes that go with them)");
  tangled.report(
      report, Severity::error, "tangled-cell", hexahedral ? "cell folds" : "curved cell folds",
      hexahedral ? "cells fold" : "curved cells fold",
      hexahedral ? "over themselves (Jacobian <= 0 at a corner or an integration point); untangle the mesh"
                 : "over themselves (Jacobian <= 0); straighten their edges or optimize the mesh of order 2");
  slivers.report(report, Severity::warning, "sliver", "cell is", "cells are",
                 join("nearly flat (quality down to ", report.worst_quality, ", dihedral angle down to ",
                      report.smallest_dihedral_deg, " degrees); optimize the mesh"));
}

void check_duplicates(const Mesh& mesh, MeshReport& report) {
  const auto width = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  const std::size_t corner_count = cell_shape(mesh.cell_type).corners;
  std::vector<std::pair<std::array<Index, 8>, Index>> key(at(mesh.cell_count()));
  for (Index c = 0; c < mesh.cell_count(); ++c) {
    auto& corners = key[at(c)].first;
    corners.fill(-1);
    std::copy_n(&mesh.cells[width * at(c)], corner_count, corners.begin());
    std::sort(corners.begin(), corners.end());
    key[at(c)].second = c;
  }
  std::sort(key.begin(), key.end());
  Tally duplicates;
  for (std::size_t i = 1; i < key.size(); ++i) {
    if (key[i].first == key[i - 1].first) duplicates.add(cell_label(mesh, key[i].second));
  }
  duplicates.report(report, Severity::error, "duplicate-cell", "cell repeats", "cells repeat",
                    "the corners of another; remove the copies");
}

// Cells that meet at an edge must agree on its middle node, or a crack runs between them.
void check_mid_edges(const Mesh& mesh, MeshReport& report) {
  if (mesh.cell_type != CellType::tet10) return;
  struct Edge {
    std::array<Index, 2> ends;
    Index middle, cell;
  };
  std::vector<Edge> edges;
  edges.reserve(6 * at(mesh.cell_count()));
  for (Index c = 0; c < mesh.cell_count(); ++c) {
    const Index* n = &mesh.cells[10 * at(c)];
    for (std::size_t e = 0; e < 6; ++e) {
      const auto [a, b] = std::minmax(n[tet_edges[e][0]], n[tet_edges[e][1]]);
      edges.push_back({{a, b}, n[4 + e], c});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return a.ends != b.ends ? a.ends < b.ends
                            : (a.middle != b.middle ? a.middle < b.middle : a.cell < b.cell);
  });
  Tally split;
  for (std::size_t i = 1; i < edges.size(); ++i) {
    if (edges[i].ends == edges[i - 1].ends && edges[i].middle != edges[i - 1].middle) {
      split.add(cell_label(mesh, edges[i].cell));
    }
  }
  split.report(report, Severity::error, "split-mid-edge", "cell has", "cells have",
               "another mid-edge node than a neighbor on the same edge; merge the nodes");
}

void check_regions(const Mesh& mesh, MeshReport& report) {
  std::vector<bool> used(std::max<std::size_t>(1, mesh.regions.size()), false);
  if (mesh.cell_region.empty()) used[0] = true;
  for (const Index r : mesh.cell_region) used[at(r)] = true;
  for (std::size_t r = 0; r < mesh.regions.size(); ++r) {
    if (used[r]) continue;
    report.findings.push_back(
        {Severity::warning,
         "empty-region",
         join("region '", mesh.regions[r], "' has no cells; a material for it has no effect"),
         1,
         {}});
  }
}

}  // namespace

void check_cells(const Mesh& mesh, MeshReport& report) {
  if (mesh.cell_type == CellType::tri3)
    check_triangles(mesh, report);
  else
    check_shapes(mesh, report);
  check_duplicates(mesh, report);
  check_mid_edges(mesh, report);
  check_regions(mesh, report);
}

}  // namespace isochor::mesh_files
