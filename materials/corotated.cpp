// psi = mu |F - R|^2 + lambda/2 tr^2(S - 1) (corotated) or + lambda/2 (J - 1)^2 (fixed corotated) [Pa]; F = R
// S with a proper rotation R, so |F - R|^2 = sum (sigma_i - 1)^2 also for inverted F.
#include <algorithm>

#include "materials/energy_model.h"
#include "materials/stretch_batch.h"

namespace isochor {

namespace {

// R turns abruptly where sigma_1 + sigma_2 = 0 (inverted as far as stretched): the second derivative is
// infinite there. This bounds it.
constexpr double kLeastSum = 1e-10;

struct CorotatedEnergy {
  double mu, lambda;  // [Pa]
  bool by_volume;     // the fixed form

  StretchResponse operator()(Want, const double s[3]) const {
    StretchResponse r;
    const double trace = (s[0] - 1) + (s[1] - 1) + (s[2] - 1);
    const double p = by_volume ? 0 : lambda * trace;
    for (int i = 0; i < 3; ++i) {
      const double d = s[i] - 1;
      const double sum = std::max(s[(i + 1) % 3] + s[(i + 2) % 3], kLeastSum);
      r.psi += mu * d * d;
      r.d[i] = 2 * mu * d + p;
      r.dd[i] = 2 * mu + (by_volume ? 0 : lambda);
      r.twist[i] = 2 * mu + 2 * (p - 2 * mu) / sum;
      r.flip[i] = 2 * mu;
      r.dd[3 + i] = by_volume ? 0 : lambda;
    }
    if (by_volume) {
      const double d = s[0] * s[1] * s[2] - 1;
      add_volume_term(s, 0.5 * lambda * d * d, lambda * d, lambda, r);
    } else {
      r.psi += 0.5 * lambda * trace * trace;
    }
    return r;
  }
};

Result<MaterialPtr> make(std::string_view name, const ElasticConstants& constants, bool by_volume) {
  auto e = linear_elastic(name, constants, 0);
  if (!e) return e.failure();
  const LinearElastic& small = e.value();
  auto rows = inverse_kappa(name, small, 0, constants.bulk_choice);
  const auto energy = [&](double lambda) {
    return std::make_shared<StretchMaterial<CorotatedEnergy>>(name,
                                                              CorotatedEnergy{small.mu, lambda, by_volume});
  };
  EnergyModel m{name, small, rows.value(), energy(0), nullptr, true};
  if (!small.incompressible()) m.complete = energy(small.lambda());
  return make_model(std::move(m));
}

}  // namespace

Result<MaterialPtr> corotated(const ElasticConstants& constants) {
  return make("corotated", constants, false);
}

Result<MaterialPtr> fixed_corotated(const ElasticConstants& constants) {
  return make("fixed_corotated", constants, true);
}

}  // namespace isochor
