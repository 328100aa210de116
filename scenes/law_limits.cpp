#include "scenes/law_limits.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text.h"

namespace isochor {

namespace {

// The stretch in tension at which I - 3 = s^2 + 2/s - 3 is jm.
double locking_stretch(double jm) {
  double low = 1, high = std::sqrt(jm + 3) + 1;
  for (int i = 0; i < 100; ++i) {
    const double s = 0.5 * (low + high);
    (s * s + 2 / s - 3 < jm ? low : high) = s;
  }
  return low;
}

}  // namespace

std::string law_limit_reached(const SceneDef& scene, const BuiltScene& built) {
  for (std::size_t b = 0; b < scene.bodies.size() && b < built.bodies.size(); ++b) {
    for (const MaterialDef& m : scene.bodies[b].materials) {
      const bool isochoric = m.law == MaterialLaw::isochoric_gent;
      if (!isochoric && m.law != MaterialLaw::gent) continue;
      const BodyFields fields = built.world.fields(built.bodies[b]);
      double nearest = 0, stretch = 0;
      for (std::size_t c = 0; c < fields.cell_max_stretch.size(); ++c) {
        // The largest I that a largest stretch s and J leave possible: s twice.
        const double s = fields.cell_max_stretch[c], J = fields.cell_J[c], third = J / (s * s);
        const double I = (2 * s * s + third * third) / (isochoric ? std::cbrt(J * J) : 1.0);
        if (!(I - 3 > nearest)) continue;
        nearest = I - 3;
        stretch = s;
      }
      if (nearest < 0.9 * m.own.jm) continue;
      return "body \"" + scene.bodies[b].name + "\" is stretched to " + number(stretch) +
             ", and its law of Gent has no value from I - 3 = jm = " + number(m.own.jm) +
             " on, in tension a stretch of " + number(locking_stretch(m.own.jm)) +
             "; take a larger jm, or load it less";
    }
  }
  return {};
}

}  // namespace isochor
