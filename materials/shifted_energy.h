// Psi(I, J) = W(I) - 2 W'(3) (J - 1) + kappa/2 (J - 1)^2 [Pa]: the common form of the inversion-safe
// energies.
//
// The middle term balances the stress of W at rest. It is what the published forms reach by a shifted rest
// volume, kappa/2 (J - alpha)^2 with alpha = 1 + 2 W'(3)/kappa (the same up to a constant), or by a target of
// volume rows whose multiplier rests at -2 W'(3). Here multipliers are counted from rest, so kappa = 0 leaves
// the distortional part, which is free of stress at rest and works at nu = 0.5.
#pragma once

#include <memory>

#include "materials/energy_batch.h"

namespace isochor {

struct StrainPart {
  double value, first, second;  // W, dW/dI, d2W/dI2
};

// `W` has: StrainPart operator()(double I) const with W(3) = 0.
template <class W>
struct ShiftedEnergy {
  W strain;
  double kappa = 0;                    // [Pa]
  double shift = 2 * strain(3).first;  // [Pa]
  InvariantResponse operator()(double I, double J) const {
    const StrainPart w = strain(I);
    const double d = J - 1;
    InvariantResponse r;
    r.psi = w.value + d * (0.5 * kappa * d - shift);
    r.I = w.first;
    r.II = w.second;
    r.J = kappa * d - shift;
    r.JJ = kappa;
    return r;
  }
};

template <class W>
std::shared_ptr<const Material> shifted_energy(std::string_view name, const W& strain, double kappa) {
  return std::make_shared<InvariantMaterial<ShiftedEnergy<W>>>(name, ShiftedEnergy<W>{strain, kappa});
}

}  // namespace isochor
