// psi = mu/2 (a(J) I - 3) + K/2 (J - 1)^2 [Pa] with a = J^(-2/3) (Bonet & Wood; Rivlin), or a = alpha^2 with
// alpha = J^(-1/3) continued to the second order below a threshold, so that it lives through inversion
// (F-bar extended: Sheen, Larionov & Pai 2021).
#include <cmath>
#include <limits>

#include "engine/base/text.h"
#include "materials/energy_batch.h"
#include "materials/energy_model.h"

namespace isochor {

namespace {

struct IsochoricEnergy {
  double mu = 0, kappa = 0;  // [Pa]
  double threshold = 0;      // J below which alpha is continued; 0: not at all

  InvariantResponse operator()(double I, double J) const {
    InvariantResponse r;
    if (threshold == 0 && !(J > 0)) {
      r.psi = std::numeric_limits<double>::infinity();
      return r;
    }
    const bool continued = J < threshold;
    const double base = continued ? threshold : J;
    double alpha = 1 / std::cbrt(base);
    double first = -alpha / (3 * base);
    const double second = -4 * first / (3 * base);
    if (continued) {
      const double d = J - threshold;
      alpha += d * (first + 0.5 * second * d);
      first += second * d;
    }
    const double a = alpha * alpha, da = 2 * alpha * first, dda = 2 * (first * first + alpha * second);
    const double d = J - 1;
    r.psi = mu / 2 * (a * I - 3) + kappa / 2 * d * d;
    r.I = mu / 2 * a;
    r.J = mu / 2 * (da * I) + kappa * d;
    r.IJ = mu / 2 * da;
    r.JJ = mu / 2 * dda * I + kappa;
    return r;
  }
};

Result<MaterialPtr> make(std::string_view name, const ElasticConstants& constants, double threshold) {
  auto e = linear_elastic(name, constants, -0.99);
  if (!e) return e.failure();
  const LinearElastic& small = e.value();
  const auto energy = [&](double kappa) {
    return std::make_shared<InvariantMaterial<IsochoricEnergy>>(name,
                                                                IsochoricEnergy{small.mu, kappa, threshold});
  };
  EnergyModel m{name, small, small.inverse_bulk, energy(0), nullptr, threshold > 0};
  if (!small.incompressible()) m.complete = energy(1 / small.inverse_bulk);
  return make_model(std::move(m));
}

}  // namespace

Result<MaterialPtr> isochoric_neo_hookean(const ElasticConstants& constants) {
  return make("isochoric_neo_hookean", constants, 0);
}

Result<MaterialPtr> isochoric_extended(const ElasticConstants& constants, double threshold) {
  if (!(threshold > 0) || !(threshold < 1)) {
    return Error{"isochoric_extended: threshold = " + number(threshold) +
                 "; the volume ratio below which the energy is continued must lie between 0 and 1, both "
                 "excluded (0.1 is usual)"};
  }
  return make("isochoric_extended", constants, threshold);
}

}  // namespace isochor
