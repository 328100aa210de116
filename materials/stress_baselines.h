// Stresses that are no derivative of an energy: baselines that papers compare with. They have no merit
// function and an unsymmetric tangent, so the engine does not run them; here they are at a material point.
#pragma once

#include <algorithm>
#include <cmath>

#include "engine/math/svd3.h"

namespace isochor {

// P = mu J^(-2/3) F [Pa], J > 0: the isochoric neo-Hookean stress without its pressure part.
inline void simplified_isochoric_stress(double mu, const Lanes F[9], Lanes P[9]) {
  const Lanes J = F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) +
                  F[2] * (F[3] * F[7] - F[4] * F[6]);
  Lanes factor;
  for (int l = 0; l < kLanes; ++l) factor[l] = mu / (std::cbrt(J[l]) * std::cbrt(J[l]));
  for (int i = 0; i < 9; ++i) P[i] = factor * F[i];
}

// The neo-Hookean stress (log volume term) with principal stretches raised to `threshold` > 0 before it is
// evaluated, in the rotation-variant frame: finite for every F (Irving, Teran & Fedkiw 2004).
inline void filtered_neo_hookean_stress(double mu, double lambda, double threshold, const Lanes F[9],
                                        Lanes P[9]) {
  Svd3 svd;
  svd3(F, svd);
  Lanes stress[3];
  for (int l = 0; l < kLanes; ++l) {
    double s[3], log_J = 0;
    for (int i = 0; i < 3; ++i) s[i] = std::max(svd.sigma[i][l], threshold), log_J += std::log(s[i]);
    for (int i = 0; i < 3; ++i) stress[i][l] = mu * s[i] + (lambda * log_J - mu) / s[i];
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      P[3 * i + j] = broadcast(0);
      for (int k = 0; k < 3; ++k) P[3 * i + j] += svd.U[3 * i + k] * stress[k] * svd.V[3 * j + k];
    }
  }
}

}  // namespace isochor
