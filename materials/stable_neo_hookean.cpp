#include "materials/stable_neo_hookean.h"

#include "materials/energy_model.h"

namespace isochor {

namespace {

template <class W>
Result<MaterialPtr> stable(std::string_view name, const ElasticConstants& constants, double mu_factor,
                           double kappa_shift) {
  auto e = linear_elastic(name, constants, -0.99);
  if (!e) return e.failure();
  const LinearElastic& small = e.value();
  auto consistent = inverse_kappa(name, small, kappa_shift * small.mu);
  if (!consistent) return consistent.failure();
  auto rows = inverse_kappa(name, small, kappa_shift * small.mu, constants.bulk_choice);
  const W strain{mu_factor * small.mu};
  EnergyModel m{name, small, rows.value(), shifted_energy(name, strain, 0), nullptr, true};
  if (!small.incompressible()) m.complete = shifted_energy(name, strain, kappa_of(consistent.value()));
  return make_model(std::move(m));
}

}  // namespace

Result<MaterialPtr> stable_neo_hookean(const ElasticConstants& constants) {
  return stable<LinearStrainPart>("stable_neo_hookean", constants, 1, 1);
}

Result<MaterialPtr> stable_neo_hookean_barrier(const ElasticConstants& constants) {
  return stable<BarrierStrainPart>("stable_neo_hookean_barrier", constants, 4.0 / 3, 5.0 / 6);
}

}  // namespace isochor
