// Closed surfaces: what makes one, what is inside, and how it is distributed.
#pragma once

#include "isochor/solids.h"

namespace isochor {

// The surface with coinciding points merged, triangles without three points left out, and wound outward; or
// why it does not enclose a solid.
Result<TriangleSurface> closed_surface(const TriangleSurface& surface);

// Volume, its middle, and the integral of (y_i - middle_i)(y_j - middle_j) over it divided by the volume
// (packed xx, yy, zz, xy, xz, yz) [m^2], exact for triangles.
struct SolidMoments {
  double volume = 0;
  Vec3 middle{};
  std::array<double, 6> second{};
};
SolidMoments moments_of(const TriangleSurface& surface);

}  // namespace isochor
