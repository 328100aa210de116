// psi = mu/2 (I - 3) - mu log J [Pa] (Frâncu et al. 2021), with lambda/2 log^2 J or Ogden's lambda/2 (J -
// 1)^2.
#pragma once

#include "materials/energy_batch.h"

namespace isochor {

enum class VolumeTerm : std::uint8_t { logarithmic, ogden };

struct NeoHookeanEnergy {
  double mu = 0, lambda = 0;  // [Pa]; lambda = 0: the distortional part
  VolumeTerm term = VolumeTerm::logarithmic;
  InvariantResponse operator()(double I, double J) const;
};

}  // namespace isochor
