// psi = mu/2 (I - 3) - mu log J + lambda/2 log^2 J [Pa]; lambda = 0: the distortional part (Frâncu et al.
// 2021).
#pragma once

#include "materials/energy_batch.h"

namespace isochor {

struct NeoHookeanEnergy {
  double mu = 0, lambda = 0;  // [Pa]
  InvariantResponse operator()(double I, double J) const;
};

}  // namespace isochor
