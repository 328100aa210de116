// W = c1 (exp(c2 (I - 3)) - 1) - c1 c2/2 (II - 3) [Pa] (Veronda & Westmann 1970).
#include <cmath>

#include "engine/base/text.h"
#include "materials/strain_law.h"

namespace isochor {

namespace {

struct VerondaWestmannStrain {
  static constexpr bool kSecond = true;
  double c1, c2;  // [Pa], [-]
  StrainPartBatch operator()(const Lanes& I, const Lanes& II) const {
    const Lanes growth = expm1(c2 * (I - 3)), e = growth + 1;
    StrainPartBatch w;
    w.value = c1 * growth - 0.5 * c1 * c2 * (II - 3);
    w.d1 = c1 * c2 * e;
    w.d2 = broadcast(-0.5 * c1 * c2);
    w.d11 = c1 * c2 * c2 * e;
    return w;
  }
};

Result<MaterialPtr> make(std::string_view name, const VerondaWestmannConstants& c, bool isochoric) {
  for (const auto& [key, value] : {std::pair{"c1", c.c1}, {"c2", c.c2}}) {
    if (value > 0 && std::isfinite(value)) continue;
    return Error{std::string(name) + ": " + key + " = " + number(value) + "; it must be a positive number"};
  }
  return strain_model({name, "c1 c2", c.poisson, c.volume, isochoric}, VerondaWestmannStrain{c.c1, c.c2},
                      Stability::in_question);
}

}  // namespace

Result<MaterialPtr> veronda_westmann(const VerondaWestmannConstants& constants) {
  return make("veronda_westmann", constants, false);
}

Result<MaterialPtr> isochoric_veronda_westmann(const VerondaWestmannConstants& constants) {
  return make("isochoric_veronda_westmann", constants, true);
}

}  // namespace isochor
