// psi = sum_p mu_p/alpha_p (sum_i sigma_i^alpha_p - 3) - (sum_p mu_p) log J + lambda/2 log^2 J [Pa]: Ogden
// 1972 in the coupled compressible form.
#include <cmath>
#include <limits>

#include "engine/base/text.h"
#include "materials/native_constants.h"
#include "materials/stretch_batch.h"

namespace isochor {

namespace {

// Powers of smaller stretches leave the range of numbers; no material gets there.
constexpr double kLeastStretch = 1e-30;

struct OgdenEnergy {
  std::vector<OgdenTerm> terms;
  double lambda = 0;  // [Pa]
  double sum = 0;     // of mu_p [Pa]

  StretchResponse operator()(Want want, const double s[3]) const {
    StretchResponse r;
    if (!(s[2] > kLeastStretch)) {
      r.psi = std::numeric_limits<double>::infinity();
      return r;
    }
    const double log_s[3] = {std::log(s[0]), std::log(s[1]), std::log(s[2])};
    const double log_J = log_s[0] + log_s[1] + log_s[2];
    for (const OgdenTerm& t : terms) add_term(t, want, s, log_s, r);
    const double q = lambda * log_J - sum;
    r.psi += log_J * (0.5 * lambda * log_J - sum);
    for (int i = 0; i < 3; ++i) {
      const double sj = s[(i + 1) % 3], sk = s[(i + 2) % 3];
      r.d[i] += q / s[i];
      r.dd[i] += (lambda - q) / (s[i] * s[i]);
      r.twist[i] += q / (sj * sk);
      r.flip[i] -= q / (sj * sk);
      for (int j = i + 1; j < 3; ++j) r.dd[off_diagonal(i, j)] += lambda / (s[i] * s[j]);
    }
    return r;
  }

 private:
  static void add_term(const OgdenTerm& t, Want want, const double s[3], const double log_s[3],
                       StretchResponse& r) {
    double power[3];  // sigma^(alpha - 1)
    for (int i = 0; i < 3; ++i) {
      power[i] = std::exp((t.alpha - 1) * log_s[i]);
      r.psi += t.mu / t.alpha * std::expm1(t.alpha * log_s[i]);
      r.d[i] += t.mu * power[i];
    }
    if (want != Want::hessian) return;
    for (int i = 0; i < 3; ++i) {
      const int j = i == 0 ? 1 : 0, k = 3 - i - j;  // s_k <= s_j: the stretches come in order
      r.dd[i] += t.mu * (t.alpha - 1) * power[i] / s[i];
      r.twist[i] += t.mu * (power[j] + power[k]) / (s[j] + s[k]);
      // (s_j^m - s_k^m) / (s_j - s_k) by the relative difference, exact where the two coincide.
      const double m = t.alpha - 1, d = (s[j] - s[k]) / s[k];
      const double quotient = d == 0 ? m : std::expm1(m * std::log1p(d)) / d;
      r.flip[i] += t.mu * power[k] / s[k] * quotient;
    }
  }
};

}  // namespace

Result<MaterialPtr> ogden(const OgdenConstants& c) {
  constexpr std::string_view name = "ogden";
  if (c.terms.empty()) return Error{"ogden: there are no terms; give at least one pair of mu and alpha"};
  double twice_mu = 0, sum = 0;
  for (std::size_t p = 0; p < c.terms.size(); ++p) {
    const double product = c.terms[p].mu * c.terms[p].alpha;
    if (!(product > 0) || !std::isfinite(product)) {
      return Error{"ogden: term " + std::to_string(p + 1) + " has mu = " + number(c.terms[p].mu) +
                   " Pa and alpha = " + number(c.terms[p].alpha) +
                   "; their product must be positive, or the stress would fall with the stretch"};
    }
    twice_mu += product;
    sum += c.terms[p].mu;
  }
  auto e = small_strain(name, "sum of mu alpha / 2", twice_mu / 2, c.poisson, 0);
  if (!e) return Error{e.error()};
  auto inverse = inverse_kappa(name, e.value(), 0);
  if (!inverse) return Error{inverse.error()};
  const auto energy = [&](double lambda) {
    return std::make_shared<StretchMaterial<OgdenEnergy>>(name, OgdenEnergy{c.terms, lambda, sum});
  };
  EnergyModel m{name, e.value(), inverse.value(), energy(0), nullptr, false};
  if (!e.value().incompressible()) m.complete = energy(kappa_of(inverse.value()));
  return make_model(std::move(m));
}

}  // namespace isochor
