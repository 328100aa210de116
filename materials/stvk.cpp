// psi = mu |E|^2 + lambda/2 tr^2 E [Pa] with E = (F^T F - 1)/2 (St. Venant-Kirchhoff), and for J < 1 on
// request the resistance k/12 ((1 - J)/6)^3 against compression.
#include <cmath>

#include "engine/base/text.h"
#include "materials/energy_model.h"
#include "materials/stretch_batch.h"

namespace isochor {

namespace {

struct StvkEnergy {
  double mu, lambda, resistance;  // [Pa]

  StretchResponse operator()(Want, const double s[3]) const {
    StretchResponse r;
    const double e[3] = {s[0] * s[0] - 1, s[1] * s[1] - 1, s[2] * s[2] - 1};  // twice the strains
    const double half_trace = (e[0] + e[1] + e[2]) / 2;
    const double p = lambda * half_trace;
    r.psi = lambda / 2 * half_trace * half_trace;
    for (int i = 0; i < 3; ++i) {
      const double sj = s[(i + 1) % 3], sk = s[(i + 2) % 3];
      r.psi += mu / 4 * e[i] * e[i];
      r.d[i] = s[i] * (mu * e[i] + p);
      r.dd[i] = mu * (3 * s[i] * s[i] - 1) + p + lambda * s[i] * s[i];
      r.twist[i] = mu * (sj * sj - sj * sk + sk * sk - 1) + p;
      r.flip[i] = mu * (sj * sj + sj * sk + sk * sk - 1) + p;
      for (int j = i + 1; j < 3; ++j) r.dd[off_diagonal(i, j)] = lambda * s[i] * s[j];
    }
    const double q = (1 - s[0] * s[1] * s[2]) / 6;
    if (resistance > 0 && q > 0) {
      add_volume_term(s, resistance / 12 * q * q * q, -resistance / 24 * q * q, resistance / 72 * q, r);
    }
    return r;
  }
};

Result<MaterialPtr> make(std::string_view name, const ElasticConstants& constants, double resistance) {
  auto e = linear_elastic(name, constants, 0);
  if (!e) return e.failure();
  const LinearElastic& small = e.value();
  auto rows = inverse_kappa(name, small, 0, constants.bulk_choice);
  const auto energy = [&](double lambda) {
    return std::make_shared<StretchMaterial<StvkEnergy>>(name, StvkEnergy{small.mu, lambda, resistance});
  };
  EnergyModel m{name, small, rows.value(), energy(0), nullptr, true};
  if (!small.incompressible()) m.complete = energy(small.lambda());
  return make_model(std::move(m));
}

}  // namespace

Result<MaterialPtr> stvk(const ElasticConstants& constants) {
  return make("stvk", constants, 0);
}

Result<MaterialPtr> stvk_resistant(const ElasticConstants& constants, double resistance) {
  if (!(resistance > 0) || !std::isfinite(resistance)) {
    return Error{"stvk_resistant: resistance = " + number(resistance) +
                 " Pa; it must be a positive number of pascals (without resistance: stvk)"};
  }
  return make("stvk_resistant", constants, resistance);
}

}  // namespace isochor
