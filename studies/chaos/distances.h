// Signed distances to obstacles, written down again for the judge.
#pragma once

#include <span>
#include <vector>

#include "isochor/contact.h"

namespace isochor::studies {

// Planes around a convex surface: normal, and its distance from the origin.
struct ConvexPlane {
  Vec3 normal{};
  double distance = 0;
};
// Nothing where the surface is not convex.
std::vector<ConvexPlane> planes_of(const TriangleSurface& surface);

// Of a point in space to an obstacle as it stands at time t; negative inside. Of shapes given by files: to
// the nearest of `planes`, inside alone, and nothing where there are none.
std::optional<double> distance_to(const Obstacle& obstacle, double t, const Vec3& x,
                                  std::span<const ConvexPlane> planes);

}  // namespace isochor::studies
