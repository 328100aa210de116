// How a shape and the points that it meets come together within an increment.
#include <algorithm>
#include <cmath>

#include "constraints/contact/rigid/contact_pool.h"

namespace isochor {

namespace {

// The first place of the straight way from y0, which is outside, to y1 inside where it is on the surface.
Vec3 first_on_surface(const Obstacle& shape, const Vec3& y0, const Vec3& y1) {
  const Vec3 way = y1 - y0;
  double low = 0, high = 1;
  if (is_solid(shape)) {
    std::array<double, 1> first{};
    if (shape.solid->crossings(y0, y1, first) > 0 && shape.rounding == 0) return y0 + first[0] * way;
  }
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high);
    (distance_value(shape, y0 + middle * way) > 0 ? low : high) = middle;
  }
  return y0 + low * way;
}

}  // namespace

// Whether the straight way ends inside where another side is nearer than the one that it came through: pushed
// out there, the point would be where no shorter increment takes it.
bool ContactPool::meets_elsewhere(Index s, const Vec3& y0, const Vec3& y1, Vec3& met) const {
  const RigidGeometry& g = geometry();
  constexpr double same_side = 0.5;  // cosine between the normals
  const double offset = g[s].offset;
  if (g.shape_points() || g[s].rider || !(distance_value(g.shape(), y1) < offset)) return false;
  met = distance_value(g.shape(), y0) > 0 ? first_on_surface(g.shape(), y0, y1) : y0;
  return dot(distance_to(g.shape(), met).normal, distance_to(g.shape(), y1).normal) < same_side;
}

Index ContactPool::passing(const StencilIncrement& increment, std::span<const Vec3> x,
                           std::span<Vec3> stopped) const {
  const RigidGeometry& g = geometry();
  const ContactFrame before = g.frame(increment.t0, increment.before), now = g.frame(increment.t1, x);
  // What is told where to go may end on either side of a node, whatever the node does.
  const bool moves = !g.shape_points() && !same_pose(before, now);
  Index count = 0;
  for (Index s = 0; s < stencils(); ++s) {
    Vec3 met{};
    const Vec3 y0 = g.own_place(s, before, increment.before), y1 = g.own_place(s, now, x);
    if (!passes_through(g.shape(), y0, y1, met) &&
        !(moves && !stopped.empty() && meets_elsewhere(s, y0, y1, met)))
      continue;
    ++count;
    if (!stopped.empty() && !g[s].rider) stopped[at(nodes_[s][0])] = now.to_world(met - g[s].inset);
  }
  return count;
}

double ContactPool::intrusion(double t0, double t1, std::span<const Vec3> from,
                              std::span<const Vec3> x) const {
  const RigidGeometry& g = geometry();
  // Of a cell: next to a side, where a node that is pushed may slip off, more of the way counts.
  constexpr double most = 0.5, most_at_side = 0.1;
  if (!g.moves() || g.shape().shape == ObstacleShape::plane) return 0;
  const ContactFrame before = g.frame(t0, x), now = g.frame(t1, x);
  if (same_pose(before, now)) return 0;
  double largest = 0;
  for (Index s = 0; s < stencils(); ++s) {
    if (!(g[s].size > 0)) continue;
    const Vec3 y0 = g.own_place(s, before, from), y1 = g.own_place(s, now, x);
    const double end = distance_value(g.shape(), y1);
    if (end > norm(y1 - y0)) continue;
    Vec3 met{};
    double way = 0;
    if (passes_through(g.shape(), y0, y1, met))
      way = norm(y1 - met) / most;
    else if (meets_elsewhere(s, y0, y1, met))
      way = norm(y1 - met) / most_at_side;
    else if (end < 0)
      way = (std::min(0.0, distance_value(g.shape(), y0)) - end) / most;
    largest = std::max(largest, way / g[s].size);
  }
  return largest;
}

}  // namespace isochor
