#include "scenes/probes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/mesh/cell_shape.h"

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

// Coordinates of the point in a hexahedron by Newton's method, which may leave far points unfinished: they
// are not inside then.
Vec3 hex_coordinates(const Mesh& mesh, const Index* cell, const Vec3& point) {
  Vec3 xi{};
  for (int iteration = 0; iteration < 20; ++iteration) {
    Vec3 d[3] = {}, r = point;
    for (std::size_t a = 0; a < 8; ++a) {
      const Vec3& X = mesh.nodes[index(cell[a])];
      const Vec3 g = hex_gradient(a, xi);
      r -= hex_function(a, xi) * X;
      for (int k = 0; k < 3; ++k) d[k] += g[k] * X;
    }
    const double j = dot(d[0], cross(d[1], d[2]));
    if (!(j > 0)) return {9, 9, 9};
    const Vec3 step =
        (1 / j) * Vec3{dot(r, cross(d[1], d[2])), dot(r, cross(d[2], d[0])), dot(r, cross(d[0], d[1]))};
    xi += step;
    if (dot(step, step) < 1e-28) break;
    if (dot(xi, xi) > 27) return {9, 9, 9};
  }
  return xi;
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

// The triangle that the point lies on, or is above or below by no more than `reach`.
MaterialPoint locate_on_sheet(const Mesh& mesh, const Vec3& point, double reach) {
  MaterialPoint found;
  double inside = -1e-6;
  for (std::size_t c = 0; c + 3 <= mesh.cells.size(); c += 3) {
    const Index* n = mesh.cells.data() + c;
    const Vec3& o = mesh.nodes[index(n[0])];
    const Vec3 a = mesh.nodes[index(n[1])] - o, b = mesh.nodes[index(n[2])] - o, p = point - o;
    const Vec3 normal = cross(a, b);
    const double square = dot(normal, normal);
    const double u = dot(cross(p, b), normal) / square, v = dot(cross(a, p), normal) / square;
    const double least = std::min({u, v, 1 - u - v});
    if (!(least > inside) || !(std::abs(dot(p, normal)) <= reach * std::sqrt(square))) continue;
    inside = least;
    found.count = 3;
    std::copy(n, n + 3, found.nodes.begin());
    found.weights = {1 - u - v, u, v};
  }
  return found;
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
  if (mesh.cell_type == CellType::tri3) {
    const MaterialPoint on_sheet = locate_on_sheet(mesh, point, 1e-6 * size);
    if (on_sheet.count > 0) return on_sheet;
    nearest.distance = std::sqrt(best);
    return nearest;
  }
  const auto stride = index(nodes_per_cell(mesh.cell_type));
  // Curved surfaces are cut by flat faces: a point a little outside is extrapolated from the cell below it.
  double inside = -0.25;
  MaterialPoint held;
  for (std::size_t c = 0; c + stride <= mesh.cells.size(); c += stride) {
    const Index* cell = mesh.cells.data() + c;
    if (mesh.cell_type == CellType::hex8) {
      const Vec3 xi = hex_coordinates(mesh, cell, point);
      const double least = 0.5 * (1 - std::max({std::abs(xi.x), std::abs(xi.y), std::abs(xi.z)}));
      if (least <= inside) continue;
      inside = least;
      held.count = 8;
      for (std::size_t a = 0; a < 8; ++a) {
        held.nodes[a] = cell[a];
        held.weights[a] = hex_function(a, xi);
      }
      continue;
    }
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
