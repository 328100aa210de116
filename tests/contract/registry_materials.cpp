#include "contract/formulas.h"
#include "contract/material_constants.h"
#include "contract/registry.h"
#include "engine/elements/material_model.h"

namespace test {

namespace {

using isochor::ElasticConstants;
using isochor::MaterialPtr;
using isochor::Result;

// A formula with the modulus of its volume part, 0 in the distortional energy.
using FormulaOfKappa = std::function<HyperDual(const Gradient9& F, double kappa)>;

struct Kind {
  std::string name, covers;
  MaterialPtr model;
  FormulaOfKappa formula;
  double kappa = 0;  // of the complete energy
  bool inverted = true;
};

void add(const Kind& kind, std::vector<MaterialCase>& out, bool objective = true, bool isotropic = true) {
  MaterialCase c;
  c.name = kind.name + ", distortional";
  c.covers = {kind.covers};
  c.material = kind.model->distortional();
  c.energy = [f = kind.formula](const Gradient9& F) { return f(F, 0); };
  c.inverted = kind.inverted;
  c.objective = objective;
  c.isotropic = isotropic;
  out.push_back(c);
  c.name = kind.name + ", complete";
  c.material = kind.model->complete().value();
  c.energy = [f = kind.formula, kappa = kind.kappa](const Gradient9& F) { return f(F, kappa); };
  out.push_back(c);
}

void add_neo_hookean(std::vector<MaterialCase>& out) {
  const auto shear = [](const Gradient9& F) {
    return 0.5 * kMu * (trace_C(F) - 3.0) - kMu * log(determinant(F));
  };
  add({"neo_hookean", "materials/neo_hookean", made(isochor::neo_hookean(constants())),
       [=](const Gradient9& F, double k) { return shear(F) + 0.5 * k * square(log(determinant(F))); },
       kLambda, false},
      out);
  add({"neo_hookean_ogden", "materials/neo_hookean", made(isochor::neo_hookean_ogden(constants())),
       [=](const Gradient9& F, double k) { return shear(F) + 0.5 * k * square(determinant(F) - 1.0); },
       kLambda, false},
      out);
}

void add_stable_neo_hookean(std::vector<MaterialCase>& out) {
  // Mooney's solid with a shifted rest volume, up to a constant.
  add({"stable_neo_hookean", "materials/stable_neo_hookean", made(isochor::stable_neo_hookean(constants())),
       [](const Gradient9& F, double k) {
         const HyperDual J = determinant(F), shear = 0.5 * kMu * (trace_C(F) - 3.0);
         if (k == 0) return shear - kMu * (J - 1.0);
         return shear + 0.5 * k * square(J - (1 + kMu / k)) - 0.5 * kMu * kMu / k;
       },
       kLambda + kMu},
      out);
  // As printed, with alpha = 1 + mu/lambda - mu/(4 lambda); shifted to zero at rest.
  constexpr double mu = 4 * kMu / 3;
  add({"stable_neo_hookean_barrier", "materials/stable_neo_hookean",
       made(isochor::stable_neo_hookean_barrier(constants())),
       [=](const Gradient9& F, double k) {
         const HyperDual J = determinant(F), I = trace_C(F);
         const HyperDual shear = 0.5 * mu * (I - 3.0) - 0.5 * mu * (log(I + 1.0) - std::log(4.0));
         if (k == 0) return shear - 0.75 * mu * (J - 1.0);
         const double alpha = 1 + mu / k - mu / (4 * k);
         return shear + 0.5 * k * (square(J - alpha) - (1 - alpha) * (1 - alpha));
       },
       kLambda + 5 * kMu / 6},
      out);
}

void add_isochoric(std::vector<MaterialCase>& out) {
  const auto energy = [](const HyperDual& a, const Gradient9& F, double k) {
    return 0.5 * kMu * (a * a * trace_C(F) - 3.0) + 0.5 * k * square(determinant(F) - 1.0);
  };
  add({"isochoric_neo_hookean", "materials/isochoric", made(isochor::isochoric_neo_hookean(constants())),
       [=](const Gradient9& F, double k) { return energy(pow(determinant(F), -1.0 / 3), F, k); }, kBulk,
       false},
      out);
  // A threshold within reach of the samples.
  constexpr double e = 0.6;
  add({"isochoric_extended", "materials/isochoric", made(isochor::isochoric_extended(constants(), e)),
       [=](const Gradient9& F, double k) {
         const HyperDual J = determinant(F);
         if (J.a > e) return energy(pow(J, -1.0 / 3), F, k);
         const HyperDual d = J - e;
         return energy(
             std::pow(e, -1.0 / 3) - std::pow(e, -4.0 / 3) / 3 * d + 2.0 / 9 * std::pow(e, -7.0 / 3) * d * d,
             F, k);
       },
       kBulk},
      out);
}

void add_corotated(std::vector<MaterialCase>& out) {
  // |F - R|^2 = I - 2 tr S + 3.
  const auto shear = [](const Gradient9& F) { return kMu * (trace_C(F) - 2.0 * trace_S(F) + 3.0); };
  add({"corotated", "materials/corotated", made(isochor::corotated(constants())),
       [=](const Gradient9& F, double k) { return shear(F) + 0.5 * k * square(trace_S(F) - 3.0); }, kLambda},
      out);
  add({"fixed_corotated", "materials/corotated", made(isochor::fixed_corotated(constants())),
       [=](const Gradient9& F, double k) { return shear(F) + 0.5 * k * square(determinant(F) - 1.0); },
       kLambda},
      out);
}

void add_stvk(std::vector<MaterialCase>& out) {
  // |E|^2 = (tr C^2 - 2 I + 3)/4.
  const auto energy = [](const Gradient9& F, double k) {
    return 0.25 * kMu * (trace_C2(F) - 2.0 * trace_C(F) + 3.0) + 0.125 * k * square(trace_C(F) - 3.0);
  };
  add({"stvk", "materials/stvk", made(isochor::stvk(constants())), energy, kLambda}, out);
  constexpr double resistance = 700;
  add({"stvk_resistant", "materials/stvk", made(isochor::stvk_resistant(constants(), resistance)),
       [=](const Gradient9& F, double k) {
         const HyperDual q = (1.0 - determinant(F)) / 6.0;
         return energy(F, k) + (q.a > 0 ? resistance / 12 * q * q * q : HyperDual());
       },
       kLambda},
      out);
}

void add_linear(std::vector<MaterialCase>& out) {
  add({"linear", "materials/linear", made(isochor::linear(constants())),
       [](const Gradient9& F, double K) {
         HyperDual squares, trace;
         for (std::size_t i = 0; i < 3; ++i) {
           for (std::size_t j = 0; j < 3; ++j) {
             squares += square(0.5 * (F[3 * i + j] + F[3 * j + i]) - (i == j ? 1.0 : 0.0));
           }
           trace += F[4 * i] - 1.0;
         }
         return kMu * (squares - square(trace) / 3.0) + 0.5 * K * square(trace);
       },
       kBulk},
      out, false, false);
}

constexpr double kC1 = 0.35, kC2 = 0.2;
isochor::MooneyRivlinConstants mooney_constants(double mu, double poisson) {
  return {kC1 / (2 * (kC1 + kC2)) * mu, kC2 / (2 * (kC1 + kC2)) * mu, poisson};
}
constexpr double kMu1 = 0.4, kMu0Share = 0.5;
isochor::FungConstants fung_constants(double mu, double poisson) {
  return {kMu0Share * mu, kMu1, (1 - kMu0Share) / kMu1 * mu, poisson};
}
constexpr double kBeta1 = 0.2, kBeta2 = 0.05;
isochor::ArrudaBoyceConstants arruda_boyce_constants(double mu, double poisson) {
  return {mu / (1 + 3 * kBeta1 + 9 * kBeta2), kBeta1, kBeta2, poisson};
}
// Exponents whose power sums are polynomials of invariants and of tr S.
isochor::OgdenConstants ogden_constants(double mu, double poisson) {
  return {{{0.7 * mu, 1}, {0.2 * mu, 2}, {0.15 * mu, 4}, {-0.1 * mu, -2}, {-0.1 * mu, -1}}, poisson};
}

void add_native(std::vector<MaterialCase>& out) {
  const auto m = mooney_constants(1.1, kPoisson);
  const double lambda = 2 * 1.1 * kPoisson / (1 - 2 * kPoisson);
  add({"mooney_rivlin", "materials/mooney_rivlin", made(isochor::mooney_rivlin(m)),
       [=](const Gradient9& F, double k) {
         const HyperDual d = determinant(F) - 1.0, I = trace_C(F), II = 0.5 * (I * I - trace_C2(F));
         return m.c1 * (I - 3.0) + m.c2 * (II - 3.0) - (2 * m.c1 + 4 * m.c2) * d + 0.5 * k * d * d;
       },
       lambda + 2 * m.c1},
      out);
  const auto f = fung_constants(1.1, kPoisson);
  add({"fung", "materials/fung", made(isochor::fung(f)),
       [=](const Gradient9& F, double k) {
         const HyperDual d = determinant(F) - 1.0, I = trace_C(F);
         const HyperDual shear = 0.5 * f.mu0 * (I - 3.0) + 0.5 * f.gamma * (exp(f.mu1 * (I - 3.0)) - 1.0);
         if (k == 0) return shear - 1.1 * d;
         const double alpha = 1 + (f.mu0 + f.gamma * f.mu1) / k;
         return shear + 0.5 * k * (square(d + (1 - alpha)) - (1 - alpha) * (1 - alpha));
       },
       lambda + 1.1 - 2 * f.gamma * f.mu1 * f.mu1},
      out);
  const auto a = arruda_boyce_constants(1.1, kPoisson);
  add({"arruda_boyce", "materials/arruda_boyce", made(isochor::arruda_boyce(a)),
       [=](const Gradient9& F, double k) {
         const HyperDual d = determinant(F) - 1.0, I = trace_C(F);
         return 0.5 * a.mu * (I - 3.0) + a.mu * a.beta1 / 4 * (I * I - 9.0) +
                a.mu * a.beta2 / 6 * (I * I * I - 27.0) - 1.1 * d + 0.5 * k * d * d;
       },
       lambda + a.mu * (1 + a.beta1 - 3 * a.beta2)},
      out);
  const auto o = ogden_constants(1.1, kPoisson);
  add({"ogden", "materials/ogden", made(isochor::ogden(o)),
       [=](const Gradient9& F, double k) {
         const HyperDual J = determinant(F), I = trace_C(F), s = trace_S(F);
         const HyperDual q = 0.5 * (s * s - I), II = 0.5 * (I * I - trace_C2(F));
         const HyperDual sums[] = {s, I, trace_C2(F), II / (J * J), q / J};
         HyperDual psi;
         double c = 0;
         for (std::size_t p = 0; p < 5; ++p) {
           psi += o.terms[p].mu / o.terms[p].alpha * (sums[p] - 3.0);
           c += o.terms[p].mu;
         }
         return psi - c * log(J) + 0.5 * k * square(log(J));
       },
       lambda, false},
      out);
}

// Formulas of the strain parts over numbers of any kind, with the modulus at small strain mu.
using StrainFormula = std::function<HyperDual(const HyperDual& I, const HyperDual& II)>;

HyperDual volume_formula(isochor::VolumeEnergy energy, const HyperDual& J) {
  switch (energy) {
    case isochor::VolumeEnergy::quadratic:
      return 0.5 * square(J - 1.0);
    case isochor::VolumeEnergy::logarithmic:
      return 0.5 * square(log(J));
    default:
      return 0.25 * (square(J) - 1.0 - 2.0 * log(J));
  }
}

// A law with constants {..., VolumePart}: `full` and `isochoric` make its two forms, `w1`, `w2` are dW/dI and
// dW/dII at rest.
struct TwoForms {
  std::string name, covers;
  std::function<Result<MaterialPtr>(isochor::VolumePart)> full, isochoric;
  StrainFormula strain;
  double w1, w2, scale = 4, largest_J = 4;
};

void add_forms(const TwoForms& law, std::vector<MaterialCase>& out) {
  constexpr double bulk = 3.1;
  const char* names[] = {"quadratic", "logarithmic", "mixed"};
  for (const auto energy :
       {isochor::VolumeEnergy::quadratic, isochor::VolumeEnergy::logarithmic, isochor::VolumeEnergy::mixed}) {
    const std::string word = names[static_cast<int>(energy)];
    for (const bool isochoric : {false, true}) {
      const auto& make = isochoric ? law.isochoric : law.full;
      if (!make) continue;
      const auto model = made(make({energy, bulk}));
      const double balance = isochoric ? 0 : 2 * law.w1 + 4 * law.w2;
      const bool quadratic = energy == isochor::VolumeEnergy::quadratic;
      const auto formula = [=, strain = law.strain](const Gradient9& F, double kappa) {
        const HyperDual J = determinant(F), I = trace_C(F), II = 0.5 * (I * I - trace_C2(F));
        const HyperDual shape =
            isochoric ? strain(pow(J, -2.0 / 3) * I, pow(J, -4.0 / 3) * II) : strain(I, II);
        const HyperDual rest = balance * (quadratic ? J - 1.0 : log(J));
        return shape - rest + kappa * volume_formula(energy, J);
      };
      const std::size_t first = out.size();
      add({(isochoric ? "isochoric_" : "") + law.name + ", " + word, law.covers, model, formula, bulk,
           !isochoric && quadratic},
          out);
      for (std::size_t i = first; i < out.size(); ++i) {
        out[i].scale = law.scale;
        out[i].largest_J = law.largest_J;
      }
    }
  }
}

void add_strain_laws(std::vector<MaterialCase>& out) {
  using isochor::VolumePart;
  add_forms({"mooney_rivlin, five terms", "materials/mooney_rivlin",
             [](VolumePart v) {
               return isochor::mooney_rivlin({0.3, 0.2, 0.5, 0.05, -0.02, 0.01, v});
             },
             [](VolumePart v) {
               return isochor::isochoric_mooney_rivlin({0.3, 0.2, 0.5, 0.05, -0.02, 0.01, v});
             },
             [](const HyperDual& I, const HyperDual& II) {
               const HyperDual x = I - 3.0, y = II - 3.0;
               return 0.3 * x + 0.2 * y + 0.05 * x * x - 0.02 * x * y + 0.01 * y * y;
             },
             0.3, 0.2},
            out);
  add_forms({"yeoh, four terms", "materials/yeoh",
             [](VolumePart v) {
               return isochor::yeoh({{0.5, -0.03, 0.002, 1e-4}, 0.5, v});
             },
             [](VolumePart v) {
               return isochor::isochoric_yeoh({{0.5, -0.03, 0.002, 1e-4}, 0.5, v});
             },
             [](const HyperDual& I, const HyperDual&) {
               const HyperDual x = I - 3.0;
               return 0.5 * x - 0.03 * x * x + 0.002 * x * x * x + 1e-4 * x * x * x * x;
             },
             0.5, 0},
            out);
  add_forms({"fung", "materials/fung",
             [](VolumePart v) {
               return isochor::fung({0.4, 0.3, 1.5, 0.5, v});
             },
             [](VolumePart v) {
               return isochor::isochoric_fung({0.4, 0.3, 1.5, 0.5, v});
             },
             [](const HyperDual& I, const HyperDual&) {
               return 0.2 * (I - 3.0) + 0.75 * (exp(0.3 * (I - 3.0)) - 1.0);
             },
             0.425, 0},
            out);
  // Coefficients as Arruda & Boyce print them, of chains of eight links.
  const auto chains = [](const HyperDual& I, const HyperDual&) {
    constexpr double C[] = {1.0 / 2, 1.0 / 20, 11.0 / 1050, 19.0 / 7000, 519.0 / 673750};
    HyperDual sum, power = 1.0;
    for (int i = 0; i < 5; ++i) {
      power = power * I;
      sum += 0.7 * C[i] / std::pow(8.0, i) * (power - std::pow(3.0, i + 1));
    }
    return sum;
  };
  double slope = 0;
  for (const auto& [i, c] :
       {std::pair{1, 0.5}, {2, 0.05}, {3, 11.0 / 1050}, {4, 19.0 / 7000}, {5, 519.0 / 673750}}) {
    slope += 0.7 * i * c * std::pow(3.0 / 8, i - 1);
  }
  add_forms({"arruda_boyce, from its locking stretch", "materials/arruda_boyce",
             [](VolumePart v) {
               return isochor::arruda_boyce({0.7, 0, 0, 0.5, 0, 0, std::sqrt(8.0), v});
             },
             [](VolumePart v) {
               return isochor::isochoric_arruda_boyce({0.7, 0, 0, 0.5, 0, 0, std::sqrt(8.0), v});
             },
             chains, slope, 0},
            out);
  add_forms(
      {"gent", "materials/gent",
       [](VolumePart v) {
         return isochor::gent({0.8, 90, 0.5, v});
       },
       [](VolumePart v) {
         return isochor::isochoric_gent({0.8, 90, 0.5, v});
       },
       [](const HyperDual& I, const HyperDual&) { return -36.0 * log(1.0 - (I - 3.0) / 90.0); }, 0.4, 0},
      out);
  add_forms({"veronda_westmann", "materials/veronda_westmann",
             [](VolumePart v) {
               return isochor::veronda_westmann({0.9, 0.3, 0.5, v});
             },
             [](VolumePart v) {
               return isochor::isochoric_veronda_westmann({0.9, 0.3, 0.5, v});
             },
             [](const HyperDual& I, const HyperDual& II) {
               return 0.9 * (exp(0.3 * (I - 3.0)) - 1.0) - 0.5 * 0.9 * 0.3 * (II - 3.0);
             },
             0.27, -0.135},
            out);
  add_forms(
      {"holmes_mow", "materials/holmes_mow", nullptr,
       [](VolumePart v) {
         return isochor::isochoric_holmes_mow({0.6, 0.25, 0.5, v});
       },
       [](const HyperDual& I, const HyperDual&) { return 0.6 / (2 * 0.25) * (exp(0.25 * (I - 3.0)) - 1.0); },
       0.3, 0},
      out);
  // Full, lambda_L is inside the exponential, and 0 there in the distortional energy.
  constexpr double mu = 0.6, lambda = 0.9, beta = 0.2;
  add({"holmes_mow", "materials/holmes_mow",
       made(isochor::holmes_mow({mu, beta, 0.5, {isochor::VolumeEnergy::logarithmic, lambda}})),
       [](const Gradient9& F, double l) {
         const HyperDual J = determinant(F), I = trace_C(F), II = 0.5 * (I * I - trace_C2(F));
         const double h = l + 2 * mu;
         const HyperDual Q = beta / h * ((2 * mu - l) * (I - 3.0) + l * (II - 3.0) - h * log(square(J)));
         return h / (4 * beta) * (exp(Q) - 1.0);
       },
       lambda, false},
      out);
}

// One of the library: neo-Hookean through the stress that a data sheet states at twice the length.
void add_named(std::vector<MaterialCase>& out) {
  constexpr double mu = 10 * 6894.757 / (2 - 0.25), nu = 0.45;
  const auto formula = [](const Gradient9& F, double kappa) {
    const HyperDual J = determinant(F);
    return 0.5 * mu * (pow(J, -2.0 / 3) * trace_C(F) - 3.0) + 0.5 * kappa * square(J - 1.0);
  };
  const std::size_t first = out.size();
  add({"named: ecoflex_00_30_data_sheet", "materials/named_materials",
       made(isochor::named_material("ecoflex_00_30_data_sheet", nu)), formula,
       2 * mu * (1 + nu) / (3 * (1 - 2 * nu)), false},
      out);
  for (std::size_t i = first; i < out.size(); ++i) out[i].scale = 10 * mu;
}

// Isochoric, with exponents whose power sums are polynomials of invariants and of tr S; and full with each U.
void add_ogden_forms(std::vector<MaterialCase>& out) {
  constexpr double bulk = 3.1;
  const char* names[] = {"quadratic", "logarithmic", "mixed"};
  for (const auto energy :
       {isochor::VolumeEnergy::quadratic, isochor::VolumeEnergy::logarithmic, isochor::VolumeEnergy::mixed}) {
    for (const bool isochoric : {false, true}) {
      auto o = ogden_constants(1.1, 0.5);
      o.volume = {energy, bulk};
      const auto formula = [=](const Gradient9& F, double kappa) {
        const HyperDual J = determinant(F), b = isochoric ? pow(J, -1.0 / 3) : HyperDual(1.0);
        const HyperDual I = b * b * trace_C(F), s = b * trace_S(F), C2 = b * b * b * b * trace_C2(F);
        const HyperDual j = b * b * b * J, q = 0.5 * (s * s - I), II = 0.5 * (I * I - C2);
        const HyperDual sums[] = {s, I, C2, II / (j * j), q / j};
        HyperDual psi;
        double c = 0;
        for (std::size_t p = 0; p < 5; ++p) {
          psi += o.terms[p].mu / o.terms[p].alpha * (sums[p] - 3.0);
          c += o.terms[p].mu;
        }
        if (!isochoric) {
          psi = psi - c * (energy == isochor::VolumeEnergy::quadratic ? J - 1.0 : log(J));
        }
        return psi + kappa * volume_formula(energy, J);
      };
      add({std::string(isochoric ? "isochoric_ogden, " : "ogden, ") + names[static_cast<int>(energy)],
           "materials/ogden", made(isochoric ? isochor::isochoric_ogden(o) : isochor::ogden(o)), formula,
           bulk, false},
          out);
    }
  }
}

// A material with constants of its own, made from E and nu by `constants_of(mu, nu)`.
template <class Make, class Constants>
ModelCase native(std::string name, std::vector<std::string> covers, Make make, Constants constants_of) {
  return {std::move(name), std::move(covers),
          [=](const ElasticConstants& c) {
            return make(constants_of(c.young / (2 * (1 + c.poisson)), c.poisson));
          },
          false};
}

}  // namespace

std::vector<MaterialCase> material_cases() {
  std::vector<MaterialCase> out;
  add_neo_hookean(out);
  add_stable_neo_hookean(out);
  add_isochoric(out);
  add_corotated(out);
  add_stvk(out);
  add_linear(out);
  add_native(out);
  add_strain_laws(out);
  add_ogden_forms(out);
  add_named(out);
  add_material_additions(out);
  return out;
}

std::vector<ModelCase> model_cases() {
  const std::vector<std::string> shared = {"materials/elastic_constants", "materials/energy_model"};
  return {
      {"neo_hookean", shared, isochor::neo_hookean},
      {"neo_hookean_ogden", shared, isochor::neo_hookean_ogden},
      {"stable_neo_hookean", shared, isochor::stable_neo_hookean},
      {"stable_neo_hookean_barrier", shared, isochor::stable_neo_hookean_barrier},
      {"isochoric_neo_hookean", shared, isochor::isochoric_neo_hookean},
      {"isochoric_extended", shared,
       [](const ElasticConstants& c) { return isochor::isochoric_extended(c, 0.1); }},
      {"corotated", shared, isochor::corotated},
      {"fixed_corotated", shared, isochor::fixed_corotated},
      {"stvk", shared, isochor::stvk},
      {"stvk_resistant", shared, [](const ElasticConstants& c) { return isochor::stvk_resistant(c, 1e5); }},
      {"linear", shared, isochor::linear},
      native("mooney_rivlin", {"materials/native_constants"}, isochor::mooney_rivlin, mooney_constants),
      native("fung", {"materials/native_constants"}, isochor::fung, fung_constants),
      native("arruda_boyce", {"materials/native_constants"}, isochor::arruda_boyce, arruda_boyce_constants),
      native("ogden", {"materials/native_constants"}, isochor::ogden, ogden_constants),
      native("isochoric_mooney_rivlin", {"materials/strain_law"}, isochor::isochoric_mooney_rivlin,
             mooney_constants),
      native("isochoric_fung", {"materials/strain_law"}, isochor::isochoric_fung, fung_constants),
      native("isochoric_arruda_boyce", {"materials/strain_law"}, isochor::isochoric_arruda_boyce,
             arruda_boyce_constants),
      native("isochoric_ogden", {"materials/strain_law"}, isochor::isochoric_ogden, ogden_constants),
      native("yeoh, log J", {"materials/strain_law", "materials/stability"}, isochor::yeoh,
             [](double mu, double nu) {
               return isochor::YeohConstants{{mu / 2, -0.01 * mu}, nu, {isochor::VolumeEnergy::logarithmic}};
             }),
      native("isochoric_yeoh, mixed", {"materials/strain_law"}, isochor::isochoric_yeoh,
             [](double mu, double nu) {
               return isochor::YeohConstants{{mu / 2, 0.1 * mu}, nu, {isochor::VolumeEnergy::mixed}};
             }),
      native("gent", {"materials/strain_law"}, isochor::gent,
             [](double mu, double nu) {
               return isochor::GentConstants{mu, 30, nu};
             }),
      native("isochoric_gent", {"materials/strain_law"}, isochor::isochoric_gent,
             [](double mu, double nu) {
               return isochor::GentConstants{mu, 30, nu};
             }),
      native("isochoric_veronda_westmann", {"materials/strain_law"}, isochor::isochoric_veronda_westmann,
             [](double mu, double nu) {
               return isochor::VerondaWestmannConstants{mu / 0.4, 0.4, nu, {isochor::VolumeEnergy::mixed}};
             }),
      native("holmes_mow", {"materials/strain_law"}, isochor::holmes_mow,
             [](double mu, double nu) {
               return isochor::HolmesMowConstants{mu, 0.5, nu};
             }),
      native("isochoric_holmes_mow", {"materials/strain_law"}, isochor::isochoric_holmes_mow,
             [](double mu, double nu) {
               return isochor::HolmesMowConstants{mu, 0.5, nu};
             }),
  };
}

}  // namespace test
