#include "materials/strain_law.h"

#include <cmath>
#include <limits>

#include "engine/base/text.h"

namespace isochor {

Result<SmallStrain> small_strain_of(const StrainLaw& law, double mu, double lambda_of_strain) {
  const std::string who(law.name);
  if (!(mu > 0) || !std::isfinite(mu)) {
    return Error{who + ": the shear modulus at small strain, " + law.shear_modulus + " = " + number(mu) +
                 " Pa, must be a positive number of pascals"};
  }
  ElasticConstants c;
  const double bulk = law.volume.bulk;
  if (bulk == -1) {
    c.young = 2 * mu * (1 + law.poisson);
    c.poisson = law.poisson;
  } else {
    if (!(bulk > 0)) {
      return Error{
          who + ": bulk = " + number(bulk) +
          " Pa; the modulus of the volume part must be a positive number of pascals, or infinity for "
          "an incompressible material"};
    }
    if (law.poisson != 0.5) {
      return Error{who + ": both poisson = " + number(law.poisson) + " and bulk = " + number(bulk) +
                   " Pa are given; give one of them"};
    }
    c.mu = mu;
    c.lambda = bulk + lambda_of_strain;
  }
  auto e = linear_elastic(law.name, c, -0.99);
  if (!e) return e.failure();
  SmallStrain small;
  small.elastic = e.value();
  small.elastic.mu = mu;
  if (bulk != -1) {
    small.inverse_kappa = 1 / bulk;
    return small;
  }
  auto inverse = inverse_kappa(law.name, e.value(), -lambda_of_strain);
  if (!inverse) return inverse.failure();
  small.inverse_kappa = inverse.value();
  return small;
}

VolumeStrain strain_of(VolumeEnergy energy) {
  switch (energy) {
    case VolumeEnergy::logarithmic:
      return VolumeStrain::logarithmic;
    case VolumeEnergy::mixed:
      return VolumeStrain::mixed;
    default:
      return VolumeStrain::linear;
  }
}

}  // namespace isochor
