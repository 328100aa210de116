// psi = mu0/2 (I - 3) + gamma/2 (exp(mu1 (I - 3)) - 1) with the volume part of shifted_energy.h [Pa].
#include <cmath>

#include "materials/native_constants.h"
#include "materials/shifted_energy.h"

namespace isochor {

namespace {

struct FungStrainPart {
  double mu0, mu1, gamma;
  StrainPart operator()(double I) const {
    const double x = mu1 * (I - 3), growth = std::expm1(x), e = growth + 1;
    return {mu0 / 2 * (I - 3) + gamma / 2 * growth, mu0 / 2 + gamma * mu1 / 2 * e, gamma * mu1 * mu1 / 2 * e};
  }
};

}  // namespace

Result<MaterialPtr> fung(const FungConstants& c) {
  constexpr std::string_view name = "fung";
  for (const auto& [key, value] : {std::pair{"mu0", c.mu0}, {"mu1", c.mu1}, {"gamma", c.gamma}}) {
    if (auto r = not_negative(name, key, value); !r) return Error{r.error()};
  }
  const double mu = c.mu0 + c.gamma * c.mu1;
  auto e = small_strain(name, "mu0 + gamma mu1", mu, c.poisson, -0.99);
  if (!e) return Error{e.error()};
  return native_model(name, e.value(), FungStrainPart{c.mu0, c.mu1, c.gamma},
                      mu - 2 * c.gamma * c.mu1 * c.mu1);
}

}  // namespace isochor
