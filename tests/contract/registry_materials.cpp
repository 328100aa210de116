#include "contract/formulas.h"
#include "contract/registry.h"
#include "engine/elements/element_guard.h"
#include "engine/elements/material_model.h"

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
  add_fibers(out);
  add_compression_penalty(out);
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
  };
}

}  // namespace test
