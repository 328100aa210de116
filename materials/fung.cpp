// W = mu0/2 (I - 3) + gamma/2 (exp(mu1 (I - 3)) - 1) [Pa].
#include "materials/exponential_strain.h"
#include "materials/native_constants.h"

namespace isochor {

namespace {

Result<MaterialPtr> make(std::string_view name, const FungConstants& c, bool isochoric) {
  for (const auto& [key, value] : {std::pair{"mu0", c.mu0}, {"mu1", c.mu1}, {"gamma", c.gamma}}) {
    if (auto r = not_negative(name, key, value); !r) return r.failure();
  }
  return strain_model({name, "mu0 + gamma mu1", c.poisson, c.volume, isochoric},
                      ExponentialStrain{c.mu0, c.gamma * c.mu1, c.mu1}, Stability::known);
}

}  // namespace

Result<MaterialPtr> fung(const FungConstants& constants) {
  return make("fung", constants, false);
}

Result<MaterialPtr> isochoric_fung(const FungConstants& constants) {
  return make("isochoric_fung", constants, true);
}

}  // namespace isochor
