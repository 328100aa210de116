// psi = mu/2 (I - 3) + mu beta1/4 (I^2 - 9) + mu beta2/6 (I^3 - 27) with the volume part of shifted_energy.h
// [Pa]: the first three terms of Arruda & Boyce 1993.
#include "materials/native_constants.h"
#include "materials/shifted_energy.h"

namespace isochor {

namespace {

struct ArrudaBoyceStrainPart {
  double mu, beta1, beta2;
  StrainPart operator()(double I) const {
    // I^2 - 9 and I^3 - 27 by their factor I - 3, which keeps the digits near rest.
    const double d = I - 3;
    return {mu * d * (0.5 + beta1 / 4 * (I + 3) + beta2 / 6 * (I * I + 3 * I + 9)),
            mu / 2 * (1 + beta1 * I + beta2 * I * I), mu / 2 * (beta1 + 2 * beta2 * I)};
  }
};

}  // namespace

Result<MaterialPtr> arruda_boyce(const ArrudaBoyceConstants& c) {
  constexpr std::string_view name = "arruda_boyce";
  for (const auto& [key, value] : {std::pair{"mu", c.mu}, {"beta1", c.beta1}, {"beta2", c.beta2}}) {
    if (auto r = not_negative(name, key, value); !r) return Error{r.error()};
  }
  auto e = small_strain(name, "mu (1 + 3 beta1 + 9 beta2)", c.mu * (1 + 3 * c.beta1 + 9 * c.beta2), c.poisson,
                        -0.99);
  if (!e) return Error{e.error()};
  return native_model(name, e.value(), ArrudaBoyceStrainPart{c.mu, c.beta1, c.beta2},
                      c.mu * (1 + c.beta1 - 3 * c.beta2));
}

}  // namespace isochor
