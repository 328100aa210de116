#include "contract/registry.h"
#include "engine/elements/element_guard.h"
#include "engine/material_model.h"

namespace test {

namespace {

using isochor::ElasticConstants;
using isochor::Material;
using isochor::MaterialPtr;

HyperDual determinant(const std::array<HyperDual, 9>& F) {
  return F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) +
         F[2] * (F[3] * F[7] - F[4] * F[6]);
}

HyperDual trace_C(const std::array<HyperDual, 9>& F) {
  HyperDual sum;
  for (const HyperDual& f : F) sum += f * f;
  return sum;
}

constexpr double kYoung = 2.6, kPoisson = 0.3;
constexpr double kMu = kYoung / (2 * (1 + kPoisson));
constexpr double kLambda = kYoung * kPoisson / ((1 + kPoisson) * (1 - 2 * kPoisson));

std::shared_ptr<const Material> complete(const MaterialPtr& model) {
  return model->complete().value();
}

MaterialPtr made(isochor::Result<MaterialPtr> result) {
  return std::move(result).value();
}

ElasticConstants constants() {
  ElasticConstants c;
  c.young = kYoung;
  c.poisson = kPoisson;
  return c;
}

void add_neo_hookean(std::vector<MaterialCase>& out) {
  const MaterialPtr model = made(isochor::neo_hookean(constants()));
  const auto energy = [](double lambda) {
    return [lambda](const std::array<HyperDual, 9>& F) {
      const HyperDual q = log(determinant(F));
      return 0.5 * kMu * (trace_C(F) - 3.0) - kMu * q + 0.5 * lambda * q * q;
    };
  };
  MaterialCase c{"neo_hookean, distortional", {"materials/neo_hookean"}, model->distortional(), energy(0)};
  out.push_back(c);
  c.name = "neo_hookean, complete";
  c.material = complete(model);
  c.energy = energy(kLambda);
  out.push_back(c);
}

void add_stable_neo_hookean(std::vector<MaterialCase>& out) {
  const MaterialPtr model = made(isochor::stable_neo_hookean(constants()));
  const auto energy = [](double lambda) {
    return [lambda](const std::array<HyperDual, 9>& F) {
      const HyperDual d = determinant(F) - 1.0;
      return 0.5 * kMu * (trace_C(F) - 3.0) - kMu * d + 0.5 * lambda * d * d;
    };
  };
  MaterialCase c{
      "stable_neo_hookean, distortional", {"materials/stable_neo_hookean"}, model->distortional(), energy(0)};
  c.inverted = true;
  out.push_back(c);
  c.name = "stable_neo_hookean, complete";
  c.material = complete(model);
  c.energy = energy(kLambda + kMu);
  out.push_back(c);
}

void add_element_guard(std::vector<MaterialCase>& out) {
  constexpr double b = 1.3, threshold = 0.5;
  MaterialCase c;
  c.name = "element_guard";
  c.material = std::make_shared<isochor::ElementGuard>(b, threshold);
  c.energy = [](const std::array<HyperDual, 9>& F) {
    const HyperDual J = determinant(F);
    if (J.a >= threshold) return HyperDual();
    const HyperDual q = log(J / threshold);
    return -b * q * q * q;
  };
  c.largest_J = 1;
  out.push_back(c);
}

}  // namespace

std::vector<MaterialCase> material_cases() {
  std::vector<MaterialCase> out;
  add_neo_hookean(out);
  add_stable_neo_hookean(out);
  add_element_guard(out);
  return out;
}

std::vector<ModelCase> model_cases() {
  return {
      {"neo_hookean", {"materials/neo_hookean", "materials/elastic_constants"}, isochor::neo_hookean},
      {"stable_neo_hookean",
       {"materials/stable_neo_hookean", "materials/elastic_constants"},
       isochor::stable_neo_hookean},
  };
}

}  // namespace test
