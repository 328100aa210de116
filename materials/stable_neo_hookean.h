// Smith, de Goes & Kim 2018: eq. 13, psi = mu/2 (I - 3) - mu (J - 1) + lambda/2 (J - 1)^2 [Pa], and eq. 14
// with the barrier at the origin, psi = mu/2 (I - 3) - mu/2 log(I + 1) + lambda/2 (J - alpha)^2.
#pragma once

#include "materials/shifted_energy.h"

namespace isochor {

struct LinearStrainPart {
  double mu = 0;  // [Pa]
  StrainPart operator()(double I) const { return {mu / 2 * (I - 3), mu / 2, 0}; }
};

// mu is that of eq. 14: 4/3 of the small-strain shear modulus.
struct BarrierStrainPart {
  double mu = 0;  // [Pa]
  StrainPart operator()(double I) const {
    const double q = 1 / (I + 1);
    return {mu / 2 * (I - 3 - std::log1p((I - 3) / 4)), mu / 2 * (1 - q), mu / 2 * q * q};
  }
};

}  // namespace isochor
