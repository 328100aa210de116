// W = c1 x + c2 y + c20 x^2 + c11 x y + c02 y^2 [Pa] with x = I - 3 and y = II - 3.
#include <cmath>

#include "engine/base/text.h"
#include "materials/strain_law.h"

namespace isochor {

namespace {

struct MooneyRivlinStrain {
  static constexpr bool kSecond = true;
  double c1, c2, c20, c11, c02;  // [Pa]
  StrainPartBatch operator()(const Lanes& I, const Lanes& II) const {
    const Lanes x = I - 3, y = II - 3;
    StrainPartBatch w;
    w.value = x * (c1 + c20 * x + c11 * y) + y * (c2 + c02 * y);
    w.d1 = c1 + 2 * c20 * x + c11 * y;
    w.d2 = c2 + c11 * x + 2 * c02 * y;
    w.d11 = broadcast(2 * c20);
    w.d12 = broadcast(c11);
    w.d22 = broadcast(2 * c02);
    return w;
  }
};

Result<MaterialPtr> make(std::string_view name, const MooneyRivlinConstants& c, bool isochoric) {
  Stability stability = Stability::known;
  for (const auto& [key, value] :
       {std::pair{"c1", c.c1}, {"c2", c.c2}, {"c20", c.c20}, {"c11", c.c11}, {"c02", c.c02}}) {
    if (!std::isfinite(value)) {
      return Error{std::string(name) + ": " + key + " = " + number(value) +
                   " Pa; it must be a finite number of pascals"};
    }
    if (value < 0) stability = Stability::in_question;
  }
  return strain_model({name, "2 (c1 + c2)", c.poisson, c.volume, isochoric},
                      MooneyRivlinStrain{c.c1, c.c2, c.c20, c.c11, c.c02}, stability);
}

}  // namespace

Result<MaterialPtr> mooney_rivlin(const MooneyRivlinConstants& constants) {
  return make("mooney_rivlin", constants, false);
}

Result<MaterialPtr> isochoric_mooney_rivlin(const MooneyRivlinConstants& constants) {
  return make("isochoric_mooney_rivlin", constants, true);
}

}  // namespace isochor
