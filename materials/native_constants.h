// Helpers for materials that are given by constants of their own instead of E and nu.
#pragma once

#include "materials/energy_model.h"
#include "materials/shifted_energy.h"

namespace isochor {

Result<void> not_negative(std::string_view material, const char* key, double value);

// Small-strain constants from the shear modulus that `formula` says, and Poisson's ratio.
Result<LinearElastic> small_strain(std::string_view material, const char* formula, double shear_modulus,
                                   double poisson, double lowest_poisson);

// A material of ShiftedEnergy with kappa = lambda_L + kappa_shift.
template <class W>
Result<MaterialPtr> native_model(std::string_view name, const LinearElastic& small, const W& strain,
                                 double kappa_shift) {
  auto inverse = inverse_kappa(name, small, kappa_shift);
  if (!inverse) return Error{inverse.error()};
  EnergyModel m{name, small, inverse.value(), shifted_energy(name, strain, 0), nullptr, true};
  if (!small.incompressible()) m.complete = shifted_energy(name, strain, kappa_of(inverse.value()));
  return make_model(std::move(m));
}

}  // namespace isochor
