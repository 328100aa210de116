#include "studies/chaos/random.h"

#include <cmath>

namespace isochor::studies {

Vec3 ChaosRandom::direction() {
  for (;;) {
    const double x = between(-1, 1), y = between(-1, 1), z = between(-1, 1);
    const double squared = x * x + y * y + z * z;
    if (squared > 1 || squared < 1e-4) continue;
    const double length = std::sqrt(squared);  // exact in IEEE arithmetic
    return {x / length, y / length, z / length};
  }
}

}  // namespace isochor::studies
