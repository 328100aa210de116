// Signed distances to rigid shapes, with exact derivatives.
#pragma once

#include "constraints/contact/shape/solid.h"
#include "isochor/effects/contact.h"

namespace isochor {

// Where an obstacle's own axes are: x_world = position + R x_own.
struct ObstaclePose {
  Vec3 position{};
  Mat3 R{{1, 0, 0, 0, 1, 0, 0, 0, 1}};

  Vec3 to_own(const Vec3& x) const { return transposed_times(R, x - position); }
  Vec3 to_world(const Vec3& y) const { return position + R * y; }
};
// `track`: what moves it.
ObstaclePose pose_of(const Obstacle& obstacle, const PoseTrack& track, double t);
inline ObstaclePose pose_of(const Obstacle& obstacle, double t) {
  return pose_of(obstacle, obstacle.motion, t);
}

// The distance to a convex shape is a convex function: its curvature is positive semi-definite.
bool is_solid(const Obstacle& shape);  // a mesh or a distance field
bool is_convex(const Obstacle& shape);
Distance distance_to(const Obstacle& shape, const Vec3& y);  // y in the obstacle's own axes
double distance_value(const Obstacle& shape, const Vec3& y);

// What bounds how deep a point can be; infinite for a plane.
double smallest_extent(const Obstacle& shape);

// Whether the straight way from y0 to y1 leads through the shape and not just around an edge or along its
// surface: it is deep inside in between and comes out (or ends) on another side. `met`: where it enters.
bool passes_through(const Obstacle& shape, const Vec3& y0, const Vec3& y1, Vec3& met);

// Parameters alone.
Result<void> check_obstacle(const Obstacle& obstacle);

}  // namespace isochor
