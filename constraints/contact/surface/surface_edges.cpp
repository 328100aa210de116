#include "constraints/contact/surface/surface_edges.h"

#include <cmath>

#include "constraints/contact/surface/crossing.h"

namespace isochor {

namespace {

constexpr double kGreatestCosine = 0.94;  // of the normals at an edge
// Depths over the size of a face: rounding; what is still next to the surface; what is far behind it.
constexpr double kShallow = 1e-3, kNear = 0.25, kDeep = 0.5;

Vec3 area_vector(const std::array<Index, 3>& c, std::span<const Vec3> x) {
  return 0.5 * cross(x[at(c[1])] - x[at(c[0])], x[at(c[2])] - x[at(c[0])]);
}

// Whether the surface bulges at the edge from a corner of a triangle with area vector n to another with m.
bool bulges(const Vec3& n, const Vec3& m, const Vec3& to_far) {
  return dot(n, m) <= kGreatestCosine * norm(n) * norm(m) && dot(n, to_far) < 0;
}

}  // namespace

SurfaceEdges::SurfaceEdges(const ContactSurface& surface, std::span<const Vec3> rest)
    : single_(surface.single()), size_(surface.size()) {
  for (int side = 0; side < 2; ++side) {
    first_[static_cast<std::size_t>(side)] = count();
    for (Index t = 0; t < surface.triangles(); ++t) {
      if (surface.side(t) != side) continue;
      const auto& c = surface.corners(t);
      for (std::size_t k = 0; k < 3; ++k) {
        const Index other = surface.across(t, k);
        if (other < t || surface.same_face(t, other)) continue;
        const Index a = c[k], b = c[(k + 1) % 3];
        Index far = -1;
        for (const Index n : surface.corners(other)) {
          if (n != a && n != b) far = n;
        }
        const Vec3 n = area_vector(c, rest), m = area_vector(surface.corners(other), rest);
        if (!bulges(n, m, rest[at(far)] - rest[at(a)])) continue;
        edge_.push_back({{a, b, c[(k + 2) % 3], far}, side, (norm(n) + norm(m)) / 3});
      }
    }
  }
  for (std::size_t side = 0; side < 2; ++side) {
    const Index end = side == 0 ? first_[1] : count();
    tree_[side].build(end - first_[side], [&](Index i) {
      const auto& n = edge_[at(first_[side] + i)].node;
      Box box(rest[at(n[0])]);
      box.add(rest[at(n[1])]);
      return box;
    });
  }
}

std::array<Index, kPairNodes> SurfaceEdges::nodes(Index edge, Index other) const {
  std::array<Index, kPairNodes> out{};
  std::copy_n(edge_[at(edge)].node.begin(), kEdgeNodes, out.begin());
  std::copy_n(edge_[at(other)].node.begin(), kEdgeNodes, out.begin() + kEdgeNodes);
  return out;
}

namespace {

std::array<Vec3, kPairNodes> places(const std::array<Index, kPairNodes>& nodes, std::span<const Vec3> x) {
  std::array<Vec3, kPairNodes> out;
  for (std::size_t i = 0; i < kPairNodes; ++i) out[i] = x[at(nodes[i])];
  return out;
}

}  // namespace

EdgeGap SurfaceEdges::gap(Index edge, Index other, std::span<const Vec3> x, double offset) const {
  return edge_gap(places(nodes(edge, other), x), offset);
}

bool SurfaceEdges::share_nodes(Index edge, Index other) const {
  const auto &a = edge_[at(edge)].node, &b = edge_[at(other)].node;
  return std::any_of(a.begin(), a.end(),
                     [&](Index n) { return std::find(b.begin(), b.end(), n) != b.end(); });
}

bool SurfaceEdges::beside(Index edge, Index other) const {
  const auto &a = edge_[at(edge)].node, &b = edge_[at(other)].node;
  return a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1];
}

bool SurfaceEdges::familiar(Index edge, Index other, std::span<const Index> partner) const {
  const Index own = partner[at(edge)], its = partner[at(other)];
  return (own >= 0 && beside(own, other)) || (its >= 0 && beside(its, edge));
}

Box SurfaceEdges::swept(Index edge, const Way& way) const {
  const auto& n = edge_[at(edge)].node;
  Box box(way.x[at(n[0])]);
  box.add(way.x[at(n[1])]);
  box.add(way.from[at(n[0])]);
  box.add(way.from[at(n[1])]);
  return box;
}

SurfaceEdges::Finding SurfaceEdges::find(Index e, const Way& way, std::span<const Box> boxes) const {
  const auto other = static_cast<std::size_t>(single_ ? 0 : 1 - edge_[at(e)].side);
  const Box around = swept(e, way).grown(way.reach);
  Finding found;
  double best = way.reach, earliest = kNever;
  const auto enter = [&](const Box& box) { return box.meets(around); };
  tree_[other].visit(boxes, enter, [&](Index i) {
    const Index o = first_[other] + i;
    if (single_ && share_nodes(e, o)) return;
    const std::array<Index, kPairNodes> pair = nodes(e, o);
    const auto start = places(pair, way.from), end = places(pair, way.x);
    const EdgeGap gap = edge_gap(end, way.offset);
    const double time = edge_crossing_time(start, end);
    if (time < kNever && gap.distance < -kDeep * size_) {
      if (time < earliest || (time == earliest && o < found.crossed)) found.crossed = o;
      earliest = std::min(earliest, time);
      return;
    }
    if (!(gap.weight > 0)) return;
    const double least = single_ ? -kShallow : -kNear;
    if (gap.distance < least * size_ && time == kNever && !familiar(e, o, way.partner)) return;
    const double depth = gap.distance < way.offset ? gap.value : gap.distance - way.offset;
    if (depth > best || (depth == best && found.deepest >= 0 && o > found.deepest)) return;
    best = depth;
    found.deepest = o;
    found.gap = gap;
    found.before = edge_gap(start, way.offset).value;
  });
  return found;
}

void SurfaceEdges::search(std::span<const Vec3> from, std::span<const Vec3> x, double reach, double offset,
                          std::span<const Index> partner, const Parallel* parallel,
                          std::span<Finding> out) const {
  const Way way{from, x, reach, offset, partner};
  std::array<std::vector<Box>, 2> boxes;
  for (std::size_t side = 0; side < 2; ++side)
    boxes[side] = tree_[side].fitted([&](Index i) { return swept(first_[side] + i, way); });
  const auto look = [&](Index begin, Index end) {
    for (Index e = begin; e < end; ++e)
      out[at(e)] = find(e, way, boxes[static_cast<std::size_t>(single_ ? 0 : 1 - edge_[at(e)].side)]);
  };
  if (parallel)
    parallel->run(count(), 64, look);
  else
    look(0, count());
}

}  // namespace isochor
