// How a shape and the points that it meets come together within an increment.
#include <algorithm>
#include <cmath>

#include "constraints/contact/rigid/contact_pool.h"

namespace isochor {

namespace {

double norm(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

bool same_pose(const ContactFrame& a, const ContactFrame& b) {
  return a.c == b.c && a.A.m == b.A.m;
}

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
  constexpr double same_side = 0.5;  // cosine between the normals
  const double offset = offset_[at(s)];
  if (points_ || rider_[at(s)] || !(distance_value(shape_, y1) < offset)) return false;
  met = distance_value(shape_, y0) > 0 ? first_on_surface(shape_, y0, y1) : y0;
  return dot(distance_to(shape_, met).normal, distance_to(shape_, y1).normal) < same_side;
}

Index ContactPool::passing(const StencilIncrement& increment, std::span<const Vec3> x,
                           std::span<Vec3> stopped) const {
  const ContactFrame before = frame(increment.t0, increment.before), now = frame(increment.t1, x);
  // What is told where to go may end on either side of a node, whatever the node does.
  const bool moves = !points_ && !same_pose(before, now);
  Index count = 0;
  for (Index s = 0; s < stencils(); ++s) {
    Vec3 met{};
    const Vec3 y0 = own_place(s, before, increment.before), y1 = own_place(s, now, x);
    if (!passes_through(shape_, y0, y1, met) &&
        !(moves && !stopped.empty() && meets_elsewhere(s, y0, y1, met)))
      continue;
    ++count;
    if (!stopped.empty() && !rider_[at(s)]) stopped[at(nodes_[s][0])] = now.to_world(met - inset_[at(s)]);
  }
  return count;
}

double ContactPool::entry(double t0, double t1, std::span<const Vec3> from, std::span<const Vec3> x) const {
  // Of a cell: next to a side, where a node that is pushed may slip off, more of the way counts.
  constexpr double most = 0.5, most_at_side = 0.1;
  if (points_ || shape_.shape == ObstacleShape::plane || shape_.motion.keys.empty()) return 0;
  const ContactFrame before = frame(t0, x), now = frame(t1, x);
  if (same_pose(before, now)) return 0;
  double largest = 0;
  for (Index s = 0; s < stencils(); ++s) {
    if (!(size_[at(s)] > 0)) continue;
    const Vec3 y0 = own_place(s, before, from), y1 = own_place(s, now, x);
    const double end = distance_value(shape_, y1);
    if (end > norm(y1 - y0)) continue;
    Vec3 met{};
    double way = 0;
    if (passes_through(shape_, y0, y1, met))
      way = norm(y1 - met) / most;
    else if (meets_elsewhere(s, y0, y1, met))
      way = norm(y1 - met) / most_at_side;
    else if (end < 0)
      way = (std::min(0.0, distance_value(shape_, y0)) - end) / most;
    largest = std::max(largest, way / size_[at(s)]);
  }
  return largest;
}

}  // namespace isochor
