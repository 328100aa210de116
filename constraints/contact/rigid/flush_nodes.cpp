#include "constraints/contact/rigid/flush_nodes.h"

#include <algorithm>
#include <cmath>

#include "engine/mesh/cell_shape.h"

namespace isochor {

namespace {

// Triangles of one plane together, largest first.
std::vector<FlatSide> sides_of_mesh(const TriangleSurface& surface) {
  constexpr double share = 0.05, same_normal = 1e-6;
  struct Side {
    FlatSide side;
    double area = 0;
  };
  std::vector<Side> sides;
  double whole = 0, extent = 0;
  for (const Vec3& p : surface.points) extent = std::max(extent, norm(p - surface.points[0]));
  struct Facet {
    FlatSide side;
    double area = 0;
  };
  std::vector<Facet> facets;
  for (std::size_t t = 0; t + 3 <= surface.triangles.size(); t += 3) {
    const Vec3 a = surface.points[at(surface.triangles[t])], b = surface.points[at(surface.triangles[t + 1])],
               c = surface.points[at(surface.triangles[t + 2])];
    const Vec3 n = cross(b - a, c - a);
    const double length = norm(n);
    if (!(length > 0)) continue;
    facets.push_back({{(1 / length) * n, dot(a, n) / length}, 0.5 * length});
    whole += 0.5 * length;
  }
  // A large side has a large facet or many small ones: those that find no side of theirs among the largest
  // few hundred are curved parts.
  std::stable_sort(facets.begin(), facets.end(),
                   [](const Facet& a, const Facet& b) { return a.area > b.area; });
  constexpr std::size_t most = 256;
  for (const Facet& f : facets) {
    const auto same = std::find_if(sides.begin(), sides.end(), [&](const Side& s) {
      return norm(s.side.normal - f.side.normal) < same_normal &&
             std::abs(s.side.place - f.side.place) < same_normal * extent;
    });
    if (same != sides.end())
      same->area += f.area;
    else if (sides.size() < most)
      sides.push_back({f.side, f.area});
  }
  std::vector<FlatSide> out;
  for (const Side& s : sides) {
    if (s.area >= share * whole) out.push_back(s.side);
  }
  return out;
}

}  // namespace

std::vector<NodeCells> cells_around(const BodyData& body, std::span<const Vec3> rest) {
  const CellShape& shape = cell_shape(body.mesh.cell_type);
  const auto per = static_cast<std::size_t>(nodes_per_cell(body.mesh.cell_type));
  const std::size_t count = body.mesh.nodes.size();
  std::vector<NodeCells> around(count);
  std::vector<Vec3> sum(count);
  std::vector<int> cells(count, 0);
  for (std::size_t c = 0; c + per <= body.global_cells.size(); c += per) {
    const Index* cell = body.global_cells.data() + c;
    Vec3 middle{};
    for (std::size_t k = 0; k < shape.corners; ++k)
      middle += (1 / static_cast<double>(shape.corners)) * rest[at(cell[k])];
    double shortest = 0;
    for (std::size_t e = 0; e < shape.edges; ++e) {
      const Index a = cell[shape.edge[e][0]], b = cell[shape.edge[e][1]];
      const double length = norm(rest[at(b)] - rest[at(a)]);
      if (e == 0 || length < shortest) shortest = length;
      for (const Index i : {a, b}) {
        double& size = around[at(i - body.first_node)].size;
        size = size > 0 ? std::min(size, length) : length;
      }
    }
    for (std::size_t k = 0; k < per; ++k) {
      const std::size_t i = at(cell[k] - body.first_node);
      sum[i] += middle - rest[at(cell[k])];
      ++cells[i];
      // Nodes in the middles of edges.
      if (k >= shape.corners)
        around[i].size = around[i].size > 0 ? std::min(around[i].size, shortest) : shortest;
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (cells[i] > 0) around[i].inward = (1.0 / cells[i]) * sum[i];
  }
  return around;
}

std::vector<FlatSide> flat_sides(const Obstacle& shape) {
  std::vector<FlatSide> sides;
  if (shape.rounding > 0) return sides;
  switch (shape.shape) {
    case ObstacleShape::box:
      for (int k = 0; k < 3; ++k) {
        Vec3 n{};
        n[k] = 1;
        sides.push_back({n, 0.5 * shape.size[k]});
        sides.push_back({-n, 0.5 * shape.size[k]});
      }
      break;
    case ObstacleShape::cylinder:
      sides.push_back({{0, 0, 1}, 0.5 * shape.length});
      sides.push_back({{0, 0, -1}, 0.5 * shape.length});
      break;
    case ObstacleShape::mesh:
      sides = sides_of_mesh(shape.solid->outline());
      break;
    default:
      break;
  }
  return sides;
}

Vec3 inset_of_flush(const Obstacle& shape, std::span<const FlatSide> sides, const Vec3& y, const Vec3& inward,
                    double size) {
  constexpr double flush = 1e-6, in = 0.05;  // of a cell
  constexpr double steep = 0.1;  // cosine between the way into the body and the normal of the side
  Vec3 inset{};
  for (const FlatSide& s : sides) {
    if (std::abs(dot(s.normal, y) - s.place) > flush * size) continue;
    if (dot(s.normal, inward) > -steep * norm(inward)) continue;
    // Of two facets in nearly one plane one counts.
    if (dot(s.normal, inset) < -0.5 * in * size) continue;
    const Vec3 deeper = inset - in * size * s.normal;
    if (distance_value(shape, y + deeper) >= -flush * size) inset = deeper;
  }
  return inset;
}

}  // namespace isochor
