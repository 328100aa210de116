// Signed distances to obstacles, written down again for the judge.
#pragma once

#include "isochor/contact.h"

namespace isochor::studies {

// Of a point in space to an obstacle as it stands at time t; negative inside. Nothing for shapes given by
// files.
std::optional<double> distance_to(const Obstacle& obstacle, double t, const Vec3& x);

}  // namespace isochor::studies
