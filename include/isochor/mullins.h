// Rubber that is softer where it has been stretched before (the Mullins effect).
#pragma once

#include "isochor/materials.h"

namespace isochor {

// Ogden & Roxburgh 1999. On the way back, and again up to the largest energy density W_m that a point has
// had, its stress is that of the law times
//   eta = 1 - erf((W_m - W) / (m + beta W_m)) / r.
struct MullinsSoftening {
  double r = 0;     // how much softer at most: eta > 1 - 1/r; above 1
  double m = 0;     // energy density [Pa] below which softening is not full; not negative
  double beta = 0;  // the same as a share of W_m; not negative. Not both zero
};

// `base`, a material whose energy without the volume part is isochoric (a name with that prefix): its volume
// part does not soften. W_m is a number a point and part of the state: saved, hashed and loaded with it. An
// increment has a potential. Fibers and fields of stiffness go around this material. Refused with the reason:
// constants out of range, a base that is not isochoric, remembers already or has a field. In worlds:
// implicit_midpoint() and gradients().
ISOCHOR_API Result<MaterialPtr> with_mullins_softening(MaterialPtr base, const MullinsSoftening& softening);

}  // namespace isochor
