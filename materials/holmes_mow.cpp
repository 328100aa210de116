// Holmes & Mow 1990 [Pa]. Full: psi = h/4 (exp(beta q) - 1)/beta with h = lambda + 2 mu and q = ((2 mu -
// lambda) (I - 3) + lambda (II - 3))/h - 2 log J, where lambda is inside the exponential and no volume part
// can be told apart. Volume rows get it at lambda = 0 and carry kappa = lambda, which is the same at small
// strain. Isochoric: mu/2 (exp(beta (I - 3)) - 1)/beta of the invariants of J^(-1/3) F.
#include <cmath>

#include "engine/base/text.h"
#include "materials/exponential_strain.h"
#include "materials/native_constants.h"

namespace isochor {

namespace {

struct HolmesMowEnergy {
  static constexpr bool kSecond = true;
  double mu, lambda, beta;  // [Pa], [Pa], [-]
  StrainResponse operator()(const Lanes& I, const Lanes& II, const Lanes& J) const {
    const double h = lambda + 2 * mu, a = (2 * mu - lambda) / h, b = lambda / h;
    const Lanes inverse = 1 / J, q = a * (I - 3) + b * (II - 3) - 2 * log(J);
    const Lanes growth = expm1(beta * q), e = h / 4 * (growth + 1), g = -2 * inverse;
    StrainResponse r;
    r.psi = h / 4 * (beta > 0 ? growth * (1 / beta) : q);
    r.I = a * e, r.II = b * e, r.J = e * g;
    r.I_I = a * a * beta * e, r.I_II = a * b * beta * e, r.II_II = b * b * beta * e;
    r.I_J = a * beta * e * g, r.II_J = b * beta * e * g;
    r.J_J = e * (beta * g * g + 2 * inverse * inverse);
    return r;
  }
};

Result<MaterialPtr> full(std::string_view name, const HolmesMowConstants& c) {
  // The default says nothing, and log J is what rows measure.
  if (c.volume.energy == VolumeEnergy::mixed) {
    return Error{
        std::string(name) +
        ": a volume energy is asked for, but this law has no volume part to choose; leave it as it is "
        "or take isochoric_holmes_mow"};
  }
  // kappa = lambda_L: that is what lambda_of_strain = 0 says.
  auto small = small_strain_of({name, "mu", c.poisson, c.volume, false}, c.mu, 0);
  if (!small) return small.failure();
  const LinearElastic& e = small.value().elastic;
  const auto energy = [&](double lambda) -> std::shared_ptr<const Material> {
    return std::make_shared<StrainMaterial<HolmesMowEnergy>>(name, HolmesMowEnergy{c.mu, lambda, c.beta});
  };
  EnergyModel m{name, e, small.value().inverse_kappa, energy(0), nullptr, false};
  if (m.inverse_kappa != 0) m.complete = energy(kappa_of(m.inverse_kappa));
  m.strain = VolumeStrain::logarithmic;
  m.separate_volume = false;
  return make_model(std::move(m));
}

}  // namespace

Result<MaterialPtr> holmes_mow(const HolmesMowConstants& constants) {
  constexpr std::string_view name = "holmes_mow";
  if (auto r = not_negative(name, "beta", constants.beta); !r) return r.failure();
  return full(name, constants);
}

Result<MaterialPtr> isochoric_holmes_mow(const HolmesMowConstants& c) {
  constexpr std::string_view name = "isochoric_holmes_mow";
  if (auto r = not_negative(name, "beta", c.beta); !r) return r.failure();
  return strain_model({name, "mu", c.poisson, c.volume, true}, ExponentialStrain{0, c.mu, c.beta},
                      Stability::known);
}

}  // namespace isochor
