// W = sum over i of c_i (I - 3)^i [Pa] (Yeoh 1993).
#include <cmath>

#include "engine/base/text.h"
#include "materials/strain_law.h"

namespace isochor {

namespace {

struct YeohStrain {
  static constexpr bool kSecond = false;
  std::vector<double> c;  // [Pa]
  StrainPartBatch operator()(const Lanes& I, const Lanes&) const {
    const Lanes x = I - 3;
    StrainPartBatch w;
    Lanes half = {};  // d11/2
    for (std::size_t i = c.size(); i-- > 0;) {
      half = half * x + w.d1;
      w.d1 = w.d1 * x + w.value;
      w.value = w.value * x + c[i];
    }
    // What Horner's scheme has now is q(x) = c_1 + c_2 x + ... with W = x q.
    w.d11 = 2 * (w.d1 + x * half);
    w.d1 = w.value + x * w.d1;
    w.value = x * w.value;
    return w;
  }
};

Result<MaterialPtr> make(std::string_view name, const YeohConstants& c, bool isochoric) {
  if (c.c.empty()) return Error{std::string(name) + ": c is empty; give at least one coefficient"};
  Stability stability = Stability::known;
  for (std::size_t i = 0; i < c.c.size(); ++i) {
    if (!std::isfinite(c.c[i])) {
      return Error{std::string(name) + ": c[" + std::to_string(i) + "] = " + number(c.c[i]) +
                   " Pa; it must be a finite number of pascals"};
    }
    if (c.c[i] < 0) stability = Stability::in_question;
  }
  return strain_model({name, "2 c[0]", c.poisson, c.volume, isochoric}, YeohStrain{c.c}, stability);
}

}  // namespace

Result<MaterialPtr> yeoh(const YeohConstants& constants) {
  return make("yeoh", constants, false);
}

Result<MaterialPtr> isochoric_yeoh(const YeohConstants& constants) {
  return make("isochoric_yeoh", constants, true);
}

}  // namespace isochor
