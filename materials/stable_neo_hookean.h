// psi = mu/2 (I - 3) - mu (J - 1) + lambda/2 (J - 1)^2 [Pa], Smith, de Goes & Kim 2018, eq. 13; lambda = 0:
// the distortional part. With the small-strain constants mu = mu_L and lambda = lambda_L + mu_L.
#pragma once

#include "materials/energy_batch.h"

namespace isochor {

struct StableNeoHookeanEnergy {
  double mu = 0, lambda = 0;  // [Pa]
  InvariantResponse operator()(double I, double J) const {
    InvariantResponse r;
    const double d = J - 1;
    r.psi = mu / 2 * (I - 3) - mu * d + lambda / 2 * d * d;
    r.I = mu / 2;
    r.J = lambda * d - mu;
    r.JJ = lambda;
    return r;
  }
};

}  // namespace isochor
