#include "materials/neo_hookean.h"

#include <cmath>
#include <limits>

#include "materials/energy_model.h"

namespace isochor {

InvariantResponse NeoHookeanEnergy::operator()(double I, double J) const {
  InvariantResponse r;
  if (!(J > 0)) {
    r.psi = std::numeric_limits<double>::infinity();
    return r;
  }
  const double log_J = std::log(J);
  r.psi = mu / 2 * (I - 3) - mu * log_J;
  r.I = mu / 2;
  if (term == VolumeTerm::logarithmic) {
    r.psi += lambda / 2 * log_J * log_J;
    r.J = (lambda * log_J - mu) / J;
    r.JJ = (lambda * (1 - log_J) + mu) / (J * J);
  } else {
    const double d = J - 1;
    r.psi += lambda / 2 * d * d;
    r.J = lambda * d - mu / J;
    r.JJ = lambda + mu / (J * J);
  }
  return r;
}

namespace {

Result<MaterialPtr> make(std::string_view name, const ElasticConstants& constants, VolumeTerm term) {
  auto e = linear_elastic(name, constants, 0);
  if (!e) return e.failure();
  const LinearElastic& small = e.value();
  auto rows = inverse_kappa(name, small, 0, constants.bulk_choice);
  const auto energy = [&](double lambda) {
    return std::make_shared<InvariantMaterial<NeoHookeanEnergy>>(name,
                                                                 NeoHookeanEnergy{small.mu, lambda, term});
  };
  EnergyModel m{name, small, rows.value(), energy(0), nullptr, false};
  if (!small.incompressible()) m.complete = energy(small.lambda());
  return make_model(std::move(m));
}

}  // namespace

Result<MaterialPtr> neo_hookean(const ElasticConstants& constants) {
  return make("neo_hookean", constants, VolumeTerm::logarithmic);
}

Result<MaterialPtr> neo_hookean_ogden(const ElasticConstants& constants) {
  return make("neo_hookean_ogden", constants, VolumeTerm::ogden);
}

}  // namespace isochor
