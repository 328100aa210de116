// psi = c1 (I - 3) + c2 (II - 3) - (2 c1 + 4 c2) (J - 1) + kappa/2 (J - 1)^2 [Pa] with II = (I^2 - tr C^2)/2,
// as function of the principal stretches. The term in J - 1 balances the stress at rest; see
// shifted_energy.h.
#include "materials/native_constants.h"
#include "materials/stretch_batch.h"

namespace isochor {

namespace {

struct MooneyRivlinEnergy {
  double c1, c2, kappa;  // [Pa]

  StretchResponse operator()(Want, const double s[3]) const {
    StretchResponse r;
    double I = 0, II = 0;
    for (int i = 0; i < 3; ++i) {
      const double sj = s[(i + 1) % 3], sk = s[(i + 2) % 3];
      I += s[i] * s[i];
      II += sj * sj * sk * sk;
      r.d[i] = s[i] * (2 * c1 + 2 * c2 * (sj * sj + sk * sk));
      r.dd[i] = 2 * c1 + 2 * c2 * (sj * sj + sk * sk);
      r.twist[i] = 2 * c1 + 2 * c2 * (s[i] * s[i] + sj * sk);
      r.flip[i] = 2 * c1 + 2 * c2 * (s[i] * s[i] - sj * sk);
      for (int j = i + 1; j < 3; ++j) r.dd[off_diagonal(i, j)] = 4 * c2 * s[i] * s[j];
    }
    r.psi = c1 * (I - 3) + c2 * (II - 3);
    const double shift = 2 * c1 + 2 * c2 * 2, d = s[0] * s[1] * s[2] - 1;
    add_volume_term(s, d * (0.5 * kappa * d - shift), kappa * d - shift, kappa, r);
    return r;
  }
};

}  // namespace

Result<MaterialPtr> mooney_rivlin(const MooneyRivlinConstants& c) {
  constexpr std::string_view name = "mooney_rivlin";
  for (const auto& [key, value] : {std::pair{"c1", c.c1}, {"c2", c.c2}}) {
    if (auto r = not_negative(name, key, value); !r) return Error{r.error()};
  }
  auto e = small_strain(name, "2 (c1 + c2)", 2 * (c.c1 + c.c2), c.poisson, -0.99);
  if (!e) return Error{e.error()};
  auto inverse = inverse_kappa(name, e.value(), 2 * c.c1);
  if (!inverse) return Error{inverse.error()};
  const auto energy = [&](double kappa) {
    return std::make_shared<StretchMaterial<MooneyRivlinEnergy>>(name, MooneyRivlinEnergy{c.c1, c.c2, kappa});
  };
  EnergyModel m{name, e.value(), inverse.value(), energy(0), nullptr, true};
  if (!e.value().incompressible()) m.complete = energy(kappa_of(inverse.value()));
  return make_model(std::move(m));
}

}  // namespace isochor
