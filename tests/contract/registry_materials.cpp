#include "contract/formulas.h"
#include "contract/registry.h"
#include "engine/elements/element_guard.h"
#include "engine/elements/material_model.h"
#include "isochor/viscoelastic.h"

namespace test {

namespace {

using isochor::ElasticConstants;
using isochor::MaterialPtr;
using isochor::Result;

constexpr double kYoung = 2.6, kPoisson = 0.3;
constexpr double kMu = kYoung / (2 * (1 + kPoisson));
constexpr double kLambda = kYoung * kPoisson / ((1 + kPoisson) * (1 - 2 * kPoisson));
constexpr double kBulk = kLambda + 2 * kMu / 3;

MaterialPtr made(Result<MaterialPtr> result) {
  return std::move(result).value();
}

ElasticConstants constants() {
  ElasticConstants c;
  c.young = kYoung;
  c.poisson = kPoisson;
  return c;
}

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

HyperDual square(const HyperDual& v) {
  return v * v;
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

// Two families, one of them dispersed, in a neo-Hookean matrix; and everything times a factor.
void add_fibers(std::vector<MaterialCase>& out) {
  isochor::FiberFamily a, b;
  a.direction = {1, 2, 2};
  a.k1 = 0.8;
  b.direction = {0, 3, -4};
  b.k1 = 0.5;
  b.k2 = 0.7;
  b.dispersion = 0.1;
  const auto fibers = [](const Gradient9& F, double x, double y, double z, double d, double k1, double k2) {
    const double n = x * x + y * y + z * z, v[3] = {x, y, z};
    HyperDual along;
    for (std::size_t i = 0; i < 3; ++i) {
      along += square(F[3 * i] * v[0] + F[3 * i + 1] * v[1] + F[3 * i + 2] * v[2]);
    }
    const HyperDual E = d * trace_C(F) + (1 - 3 * d) / n * along - 1.0;
    if (E.a <= 0) return HyperDual();
    return k2 > 0 ? k1 / (2 * k2) * (exp(k2 * E * E) - 1.0) : 0.5 * k1 * E * E;
  };
  const auto energy = [=](const Gradient9& F) {
    return 0.5 * kMu * (trace_C(F) - 3.0) - kMu * log(determinant(F)) + fibers(F, 1, 2, 2, 0, 0.8, 0) +
           fibers(F, 0, 3, -4, 0.1, 0.5, 0.7);
  };
  const MaterialPtr matrix = made(isochor::neo_hookean(constants()));
  MaterialCase c;
  c.name = "neo_hookean with fibers";
  c.covers = {"materials/fibers"};
  c.material = made(isochor::with_fibers(matrix, {a, b}))->distortional();
  c.energy = energy;
  c.isotropic = false;
  out.push_back(c);
  c.name = "neo_hookean with fibers, times 1.7";
  c.covers = {"materials/stiffness_field"};
  const std::vector<double> factor(isochor::kLanes, 1.7);
  c.material =
      made(isochor::with_stiffness_field(made(isochor::with_fibers(matrix, {a, b})), factor))->distortional();
  c.energy = [=](const Gradient9& F) { return 1.7 * energy(F); };
  out.push_back(c);
}

// psi of the toe law by Gauss quadrature of its T(s)/s, whose derivatives are those of its upper end.
HyperDual toe_energy(const HyperDual& s, double c3, double c4, double c5, double straight) {
  const auto T = [=](const HyperDual& v) {
    if (v.a <= straight) return c3 * (exp(c4 * (v - 1.0)) - 1.0);
    return c5 * v + (c3 * (std::exp(c4 * (straight - 1)) - 1) - c5 * straight);
  };
  // With five points on each of many pieces; the piece with the end scales with it.
  constexpr double x[] = {0, 0.5384693101056831, 0.9061798459386640},
                   w[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  const auto piece = [&](const HyperDual& low, const HyperDual& high) {
    HyperDual sum;
    const HyperDual middle = 0.5 * (low + high), half = 0.5 * (high - low);
    for (int i = 0; i < 3; ++i) {
      for (const double sign : {-1.0, 1.0}) {
        if (i == 0 && sign < 0) continue;
        const HyperDual v = middle + sign * x[i] * half;
        sum += w[i] * half * T(v) / v;
      }
    }
    return sum;
  };
  HyperDual psi;
  if (s.a <= 1) return psi;
  const HyperDual bend = s.a > straight ? HyperDual(straight) : s;
  constexpr int n = 40;
  for (int i = 0; i < n; ++i) {
    psi += piece(1.0 + (bend - 1.0) * (1.0 * i / n), 1.0 + (bend - 1.0) * ((i + 1.0) / n));
    if (s.a > straight) psi += piece(bend + (s - bend) * (1.0 * i / n), bend + (s - bend) * ((i + 1.0) / n));
  }
  return psi;
}

// Fibers of J^(-1/3) F, with dispersion, another exponent and the toe law, in matrices of the same kind.
void add_isochoric_fibers(std::vector<MaterialCase>& out) {
  const auto along = [](const Gradient9& F, double x, double y, double z) {
    const double n = x * x + y * y + z * z, v[3] = {x, y, z};
    HyperDual sum;
    for (std::size_t i = 0; i < 3; ++i) {
      sum += square(F[3 * i] * v[0] + F[3 * i + 1] * v[1] + F[3 * i + 2] * v[2]);
    }
    return sum / n;
  };
  const auto matrix = [](const Gradient9& F) {
    return 0.55 * (pow(determinant(F), -2.0 / 3) * trace_C(F) - 3.0);
  };
  const MaterialPtr base = made(isochor::isochoric_yeoh({{0.55}, 0.3}));
  struct Case {
    std::string name;
    isochor::FiberFamily family;
    std::function<HyperDual(const Gradient9&)> energy;
  };
  std::vector<Case> list;
  isochor::FiberFamily f;
  f.direction = {1, 2, 2};
  f.k1 = 0.8;
  f.k2 = 0.4;
  f.dispersion = 0.15;
  f.isochoric = true;
  list.push_back({"Holzapfel-Gasser-Ogden", f, [=](const Gradient9& F) {
                    const HyperDual a = pow(determinant(F), -2.0 / 3);
                    const HyperDual E = a * (0.15 * trace_C(F) + 0.55 * along(F, 1, 2, 2)) - 1.0;
                    if (E.a <= 0) return HyperDual();
                    return 0.8 / 0.8 * (exp(0.4 * E * E) - 1.0);
                  }});
  f.dispersion = 0;
  f.exponent = 3.5;
  list.push_back({"exponential power 3.5, isochoric", f, [=](const Gradient9& F) {
                    const HyperDual E = pow(determinant(F), -2.0 / 3) * along(F, 1, 2, 2) - 1.0;
                    if (E.a <= 0) return HyperDual();
                    return 0.8 / (3.5 * 0.4) * (exp(0.4 * pow(E, 3.5)) - 1.0);
                  }});
  f.isochoric = false;
  f.k2 = 0;
  list.push_back({"power 3.5", f, [=](const Gradient9& F) {
                    const HyperDual E = along(F, 1, 2, 2) - 1.0;
                    return E.a <= 0 ? HyperDual() : 0.8 / 3.5 * pow(E, 3.5);
                  }});
  f.exponent = 2;
  f.law = isochor::FiberLaw::toe;
  f.k1 = 0.2;
  f.k2 = 4;
  f.straight_modulus = 2.5;
  f.straight_stretch = 1.3;
  list.push_back({"toe", f, [=](const Gradient9& F) {
                    return toe_energy(pow(along(F, 1, 2, 2), 0.5), 0.2, 4, 2.5, 1.3);
                  }});
  f.isochoric = true;
  list.push_back({"toe, isochoric", f, [=](const Gradient9& F) {
                    return toe_energy(pow(determinant(F), -1.0 / 3) * pow(along(F, 1, 2, 2), 0.5), 0.2, 4,
                                      2.5, 1.3);
                  }});
  for (const Case& one : list) {
    MaterialCase c;
    c.name = "isochoric_yeoh with fibers, " + one.name;
    c.covers = {"materials/fibers"};
    c.material = made(isochor::with_fibers(base, {one.family}))->distortional();
    c.energy = [=, fibers = one.energy](const Gradient9& F) { return matrix(F) + fibers(F); };
    c.isotropic = false;
    c.scale = 10;
    c.largest_J = 2.5;
    out.push_back(c);
  }
}

using Matrix9 = std::array<HyperDual, 9>;

Matrix9 product(const Matrix9& A, const Matrix9& B) {
  Matrix9 C;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      C[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
  }
  return C;
}
Matrix9 sum(const Matrix9& A, double b, const Matrix9& B) {
  Matrix9 C;
  for (std::size_t i = 0; i < 9; ++i) C[i] = A[i] + b * B[i];
  return C;
}
Matrix9 inverse(const Matrix9& A) {
  Matrix9 C;
  const HyperDual det = determinant(A);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
      C[3 * i + j] = (A[3 * a + c] * A[3 * b + d] - A[3 * a + d] * A[3 * b + c]) / det;
    }
  }
  return C;
}

// By square roots until the argument is next to 1 (Denman & Beavers), and the series there.
Matrix9 logarithm(Matrix9 A) {
  Matrix9 one;
  for (std::size_t i = 0; i < 9; i += 4) one[i] = HyperDual() + 1.0;
  constexpr int roots = 6;
  for (int k = 0; k < roots; ++k) {
    Matrix9 Y = A, Z = one;
    for (int i = 0; i < 14; ++i) {
      const Matrix9 y = sum(Y, 1, inverse(Z)), z = sum(Z, 1, inverse(Y));
      for (std::size_t e = 0; e < 9; ++e) Y[e] = 0.5 * y[e], Z[e] = 0.5 * z[e];
    }
    A = Y;
  }
  const Matrix9 x = product(sum(A, -1, one), inverse(sum(A, 1, one))), square = product(x, x);
  Matrix9 power = x, log = x;
  for (int n = 3; n < 13; n += 2) {
    power = product(power, square);
    log = sum(log, 1.0 / n, power);
  }
  for (HyperDual& v : log) v = 2.0 * (1 << roots) * v;
  return log;
}

// What stays of a material with memory, and the spring of a branch.
void add_viscoelastic(std::vector<MaterialCase>& out) {
  const isochor::MaterialPtr model = made(
      isochor::with_prony_series(made(isochor::isochoric_neo_hookean(constants())), {{0.3, 1}, {0.2, 5}}));
  const auto strain = [](const Gradient9& F) {
    return trace_C(F) / exp(2.0 / 3 * log(determinant(F))) - 3.0;
  };
  MaterialCase c;
  c.covers = {"materials/viscoelastic"};
  c.name = "isochoric_neo_hookean with memory, what stays";
  c.material = model->distortional();
  c.energy = [=](const Gradient9& F) { return 0.25 * kMu * strain(F); };
  out.push_back(c);
  c.name = "isochoric_neo_hookean with memory, one field";
  c.material = model->complete().value();
  const double kappa = 1 / model->inverse_bulk();
  c.energy = [=](const Gradient9& F) {
    const HyperDual d = determinant(F) - 1.0;
    return 0.25 * kMu * strain(F) + 0.5 * kappa * d * d;
  };
  c.scale = 10;
  out.push_back(c);
  c.scale = 1;
  c.name = "logarithmic spring";
  c.material = model->memory()->branches.front().spring;
  c.energy = [](const Gradient9& F) {
    Matrix9 C;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j)
        C[3 * i + j] = F[i] * F[j] + F[3 + i] * F[3 + j] + F[6 + i] * F[6 + j];
    }
    const Matrix9 e = logarithm(C);  // twice the strain
    const HyperDual mean = (1.0 / 3) * (e[0] + e[4] + e[8]);
    HyperDual square;
    for (std::size_t i = 0; i < 9; ++i) {
      const HyperDual d = i % 4 == 0 ? e[i] - mean : e[i];
      square = square + d * d;
    }
    return 0.25 * 0.3 * kMu * square;
  };
  out.push_back(c);
}

// On a base with a barrier, and on one that lives through inversion.
void add_compression_penalty(std::vector<MaterialCase>& out) {
  const auto penalty = [](const Gradient9& F) {
    const HyperDual d = determinant(F) - 1.0;
    return 2.5 / 12 * d * d * (9.0 * d * d + 6.0);
  };
  MaterialCase c;
  c.covers = {"materials/compression_penalty"};
  c.name = "neo_hookean with compression penalty";
  c.material = made(isochor::with_compression_penalty(made(isochor::neo_hookean(constants())), {2.5, 9}))
                   ->distortional();
  c.energy = [=](const Gradient9& F) {
    return 0.5 * kMu * (trace_C(F) - 3.0) - kMu * log(determinant(F)) + penalty(F);
  };
  c.scale = 10;
  c.largest_J = 2;
  out.push_back(c);
  c.name = "stable_neo_hookean with compression penalty";
  c.material =
      made(isochor::with_compression_penalty(made(isochor::stable_neo_hookean(constants())), {2.5, 9}))
          ->distortional();
  c.energy = [=](const Gradient9& F) {
    return 0.5 * kMu * (trace_C(F) - 3.0) - kMu * (determinant(F) - 1.0) + penalty(F);
  };
  c.inverted = true;
  out.push_back(c);
}

// At one of its ratios a field of Poisson's ratio is the law at that ratio; here the second of three.
void add_poisson_field(std::vector<MaterialCase>& out) {
  const auto law = [](double nu) {
    ElasticConstants c;
    c.young = 2 * kMu * (1 + 0.3);
    c.poisson = nu;
    return isochor::stable_neo_hookean(c);
  };
  const auto field =
      made(isochor::with_poisson_field(law, {0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.1, 0.45}));
  MaterialCase c;
  c.covers = {"materials/poisson_field"};
  c.name = "stable_neo_hookean with a field of Poisson's ratio";
  c.material = std::move(field->complete()).value();
  const double lambda = 2 * kMu * 0.3 / 0.4 + kMu;
  c.energy = [=](const Gradient9& F) {
    const HyperDual d = determinant(F) - 1.0;
    return 0.5 * kMu * (trace_C(F) - 3.0) - kMu * d + 0.5 * lambda * d * d;
  };
  c.scale = 10;
  c.inverted = true;
  out.push_back(c);
}

// A material for points that began their increment at a given J.
class BeganAt final : public isochor::Material {
 public:
  BeganAt(std::shared_ptr<const isochor::Material> material, double J)
      : material_(std::move(material)), J_(J) {}
  std::string_view name() const override { return material_->name(); }
  void describe(isochor::Fingerprint& f) const override { material_->describe(f); }
  void evaluate(isochor::Want want, const isochor::PointBatch& points,
                isochor::ResponseBatch& response) const override {
    material_->evaluate(want, began(points), response);
  }
  void spectrum(const isochor::PointBatch& points, const isochor::Svd3& svd,
                isochor::Spectrum& out) const override {
    material_->spectrum(began(points), svd, out);
  }

 private:
  isochor::PointBatch began(isochor::PointBatch points) const {
    for (double& J : points.J_before) J = J_;
    return points;
  }
  std::shared_ptr<const isochor::Material> material_;
  double J_;
};

void add_element_guard(std::vector<MaterialCase>& out) {
  constexpr double b = 1.3, threshold = 0.5;
  const auto guard = std::make_shared<isochor::ElementGuard>(
      std::vector<isochor::ElementGuard::Barrier>(isochor::kLanes, {b, threshold}));
  MaterialCase c;
  c.name = "element_guard";
  c.material = std::make_shared<BeganAt>(guard, 1);
  c.energy = [](const Gradient9& F) {
    const HyperDual J = determinant(F);
    if (J.a >= threshold) return HyperDual();
    const HyperDual q = log(J / threshold);
    return -b * q * q * q;
  };
  c.largest_J = 1;
  out.push_back(c);

  c.name = "element_guard of what began inverted";
  c.material = std::make_shared<BeganAt>(guard, -0.5);
  c.energy = [](const Gradient9&) { return HyperDual(); };
  c.inverted = true;
  out.push_back(c);
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
  add_fibers(out);
  add_isochoric_fibers(out);
  add_compression_penalty(out);
  add_viscoelastic(out);
  add_poisson_field(out);
  add_element_guard(out);
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
