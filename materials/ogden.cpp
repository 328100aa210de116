// W = sum_p mu_p/alpha_p (sum_i s_i^alpha_p - 3) [Pa] over principal stretches (Ogden 1972): those of F with
// a term in J that balances the stress at rest, or those of J^(-1/3) F; each with a volume part U(J).
#include <cmath>
#include <limits>

#include "engine/base/text.h"
#include "materials/strain_law.h"
#include "materials/stretch_lanes.h"

namespace isochor {

namespace {

struct OgdenLaw {
  std::vector<OgdenTerm> terms;
  bool isochoric = false;
  VolumeTerms volume;
  StretchLanes respond(Want want, const Lanes s[3]) const;
};

StretchLanes OgdenLaw::respond(Want want, const Lanes s[3]) const {
  StretchLanes r;
  Lanes log_s[3], inverse[3], log_J = {};
  for (int i = 0; i < 3; ++i) {
    log_s[i] = log(s[i]);
    inverse[i] = 1 / s[i];
    log_J += log_s[i];
  }
  const Lanes mean = isochoric ? log_J * (1.0 / 3) : Lanes{};
  // m_i = s_i dW/ds_i and n_i = s_i dm_i/ds_i of the strain part alone.
  Lanes m[3] = {}, n[3] = {};
  for (const OgdenTerm& t : terms) {
    Lanes power[3];
    for (int i = 0; i < 3; ++i) {
      const Lanes growth = expm1(t.alpha * (log_s[i] - mean));
      r.psi += t.mu / t.alpha * growth;
      power[i] = t.mu * (growth + 1);
      m[i] += power[i];
      n[i] += t.alpha * power[i];
    }
    if (want != Want::hessian) continue;
    for (int i = 0; i < 3; ++i) {
      const int j = i == 0 ? 1 : 0, k = 3 - i - j;  // s_k <= s_j: the stretches come in order
      // (s_j^a - s_k^a)/(s_j - s_k), a = alpha - 1, by the relative difference: exact where the two coincide.
      const double a = t.alpha - 1;
      const Lanes x = (s[j] - s[k]) * inverse[k], quotient = expm1(a * log1p(x)) / x;
      r.second.flip[i] += power[k] * inverse[k] * inverse[k] * (x > 0 ? quotient : broadcast(a));
    }
  }
  // With the part of J^(-1/3): t_i = Psi_i s_i and its derivatives h.
  const Lanes q = isochoric ? (m[0] + m[1] + m[2]) * (-1.0 / 3) : Lanes{};
  Lanes t[3];
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    t[i] = isochoric ? (2 * m[i] - m[j] - m[k]) * (1.0 / 3) : m[i];
    r.d[i] = t[i] * inverse[i];
  }
  StrainResponse u;
  const Lanes J = s[0] * s[1] * s[2], g[3] = {s[1] * s[2], s[2] * s[0], s[0] * s[1]};
  volume.add(J, log_J, u);
  r.psi += u.psi;
  const Lanes all = isochoric ? (n[0] + n[1] + n[2]) * (1.0 / 9) : Lanes{};
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3, pair = 2 + j + k;
    r.d[i] += u.J * g[i];
    if (want != Want::hessian) continue;
    const Lanes jk = inverse[j] * inverse[k];
    Lanes own = n[i] - t[i], mixed = {};
    if (isochoric) own += all - n[i] * (2.0 / 3), mixed = all - (n[j] + n[k]) * (1.0 / 3);
    r.second.scaling[i] = own * inverse[i] * inverse[i] + u.J_J * g[i] * g[i];
    r.second.scaling[pair] = mixed * jk + u.J_J * g[j] * g[k] + u.J * s[i];
    r.second.twist[i] = (m[j] * inverse[j] + m[k] * inverse[k]) / (s[j] + s[k]) + q * jk + u.J * s[i];
    r.second.flip[i] += -q * jk - u.J * s[i];
  }
  keep_domain(s[2], r);
  return r;
}

Result<MaterialPtr> make(std::string_view name, const OgdenConstants& c, bool isochoric) {
  if (c.terms.empty())
    return Error{std::string(name) + ": there are no terms; give at least one pair of mu and alpha"};
  double twice_mu = 0, sum = 0;
  bool in_question = false;
  for (std::size_t p = 0; p < c.terms.size(); ++p) {
    const double product = c.terms[p].mu * c.terms[p].alpha;
    if (product == 0 || !std::isfinite(product)) {
      return Error{std::string(name) + ": term " + std::to_string(p + 1) +
                   " has mu = " + number(c.terms[p].mu) + " Pa and alpha = " + number(c.terms[p].alpha) +
                   "; both must be finite and not zero, or the term has no stress"};
    }
    in_question = in_question || product < 0;
    twice_mu += product;
    sum += c.terms[p].mu;
  }
  const double mu = twice_mu / 2;
  const bool quadratic = c.volume.energy == VolumeEnergy::quadratic;
  const double of_strain = isochoric ? -2 * mu / 3 : (quadratic ? -sum : 0);
  auto small = small_strain_of({name, "sum of mu alpha / 2", c.poisson, c.volume, isochoric}, mu, of_strain);
  if (!small) return small.failure();
  const double inverse = small.value().inverse_kappa;
  const auto energy = [&](double kappa) -> std::shared_ptr<const Material> {
    return std::make_shared<StretchLanesMaterial<OgdenLaw>>(
        name, OgdenLaw{c.terms, isochoric, {c.volume.energy, kappa, isochoric ? 0 : sum}});
  };
  EnergyModel m{name, small.value().elastic, inverse, energy(0), nullptr, false};
  if (inverse != 0) m.complete = energy(kappa_of(inverse));
  m.strain = strain_of(c.volume.energy);
  if (in_question) m.warnings = stability_warnings(name, *m.distortional);
  return make_model(std::move(m));
}

}  // namespace

Result<MaterialPtr> ogden(const OgdenConstants& constants) {
  return make("ogden", constants, false);
}

Result<MaterialPtr> isochoric_ogden(const OgdenConstants& constants) {
  return make("isochoric_ogden", constants, true);
}

}  // namespace isochor
