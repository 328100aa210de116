#include "scenes/probes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace isochor {

namespace {

std::size_t index(Index i) {
  return static_cast<std::size_t>(i);
}

std::array<double, 4> barycentric(const Mesh& mesh, const Index* cell, const Vec3& point) {
  const Vec3& o = mesh.nodes[index(cell[0])];
  const Vec3 a = mesh.nodes[index(cell[1])] - o, b = mesh.nodes[index(cell[2])] - o;
  const Vec3 c = mesh.nodes[index(cell[3])] - o, p = point - o;
  const double volume = dot(a, cross(b, c));
  const double u = dot(p, cross(b, c)) / volume, v = dot(a, cross(p, c)) / volume,
               w = dot(a, cross(b, p)) / volume;
  return {1 - u - v - w, u, v, w};
}

// Shape functions of the cell, taken with straight edges.
MaterialPoint in_cell(const Mesh& mesh, const Index* cell, const std::array<double, 4>& l) {
  MaterialPoint p;
  p.count = nodes_per_cell(mesh.cell_type);
  std::copy(cell, cell + p.count, p.nodes.begin());
  if (mesh.cell_type == CellType::tet4) {
    std::copy(l.begin(), l.end(), p.weights.begin());
    return p;
  }
  constexpr std::size_t kEdges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  for (std::size_t i = 0; i < 4; ++i) p.weights[i] = l[i] * (2 * l[i] - 1);
  for (std::size_t e = 0; e < 6; ++e) p.weights[4 + e] = 4 * l[kEdges[e][0]] * l[kEdges[e][1]];
  return p;
}

}  // namespace

Vec3 MaterialPoint::at(std::span<const Vec3> positions) const {
  Vec3 sum{};
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
    sum += weights[k] * positions[index(nodes[k])];
  return sum;
}

MaterialPoint locate(const Mesh& mesh, const Vec3& point) {
  // A node that is asked for is taken as such, also where curved cells do not quite hold it.
  MaterialPoint nearest;
  nearest.count = 1;
  nearest.weights[0] = 1;
  double best = std::numeric_limits<double>::infinity();
  Vec3 lower = point, upper = point;
  for (Index n = 0; n < mesh.node_count(); ++n) {
    const Vec3& X = mesh.nodes[index(n)];
    const Vec3 d = X - point;
    if (dot(d, d) < best) {
      best = dot(d, d);
      nearest.nodes[0] = n;
    }
    for (int k = 0; k < 3; ++k) {
      lower[k] = std::min(lower[k], X[k]);
      upper[k] = std::max(upper[k], X[k]);
    }
  }
  const double size = std::sqrt(dot(upper - lower, upper - lower));
  if (std::sqrt(best) <= 1e-9 * size) return nearest;
  const auto stride = index(nodes_per_cell(mesh.cell_type));
  // Curved surfaces are cut by flat faces: a point a little outside is extrapolated from the cell below it.
  double inside = -0.25;
  MaterialPoint held;
  for (std::size_t c = 0; c + stride <= mesh.cells.size(); c += stride) {
    const Index* cell = mesh.cells.data() + c;
    const auto l = barycentric(mesh, cell, point);
    const double least = *std::min_element(l.begin(), l.end());
    if (least > inside) {
      inside = least;
      held = in_cell(mesh, cell, l);
    }
  }
  if (held.count > 0) return held;
  nearest.distance = std::sqrt(best);
  return nearest;
}

}  // namespace isochor
