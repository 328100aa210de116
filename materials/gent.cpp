// W = -mu jm/2 log(1 - (I - 3)/jm) [Pa] (Gent 1996), without a value from I - 3 = jm on.
#include <cmath>

#include "engine/base/text.h"
#include "materials/strain_law.h"

namespace isochor {

namespace {

struct GentStrain {
  static constexpr bool kSecond = false;
  double mu, jm;  // [Pa], [-]
  StrainPartBatch operator()(const Lanes& I, const Lanes&) const {
    const Lanes y = (I - 3) * (-1 / jm), left = 1 + y;
    StrainPartBatch w;
    w.value = -0.5 * mu * jm * log1p(y);
    w.d1 = 0.5 * mu / left;
    w.d11 = w.d1 / (jm * left);
    return w;
  }
};

Result<MaterialPtr> make(std::string_view name, const GentConstants& c, bool isochoric) {
  if (!(c.jm > 0) || !std::isfinite(c.jm)) {
    return Error{std::string(name) + ": jm = " + number(c.jm) +
                 "; the value of I - 3 at which chains are straight must be a positive number"};
  }
  return strain_model({name, "mu", c.poisson, c.volume, isochoric}, GentStrain{c.mu, c.jm}, Stability::known);
}

}  // namespace

Result<MaterialPtr> gent(const GentConstants& constants) {
  return make("gent", constants, false);
}

Result<MaterialPtr> isochoric_gent(const GentConstants& constants) {
  return make("isochoric_gent", constants, true);
}

}  // namespace isochor
