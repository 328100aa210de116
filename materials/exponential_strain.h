// W = linear/2 x + product/2 (exp(rate x) - 1)/rate [Pa] with x = I - 3; rate = 0: its limit.
#pragma once

#include "materials/strain_law.h"

namespace isochor {

struct ExponentialStrain {
  static constexpr bool kSecond = false;
  double linear = 0, product = 0;  // [Pa]
  double rate = 0;                 // [-] >= 0
  StrainPartBatch operator()(const Lanes& I, const Lanes&) const {
    const Lanes x = I - 3, growth = expm1(rate * x), e = growth + 1;
    StrainPartBatch w;
    w.value = 0.5 * (linear * x + (rate > 0 ? growth * (product / rate) : product * x));
    w.d1 = 0.5 * (linear + product * e);
    w.d11 = 0.5 * product * rate * e;
    return w;
  }
};

}  // namespace isochor
