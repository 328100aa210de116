#include "scenes/body_parts.h"

namespace isochor {

namespace {

struct GivenConstant {
  const char* key;
  bool given;
  MaterialLaw law;  // the one that knows it
  const char* law_name;
};

// A constant that no one reads would be a mistake that nobody sees.
Result<void> check_constants(const MaterialDef& def) {
  const LawConstants& c = def.own;
  const GivenConstant list[] = {
      {"c1", c.c1 != 0, MaterialLaw::mooney_rivlin, "mooney_rivlin"},
      {"c2", c.c2 != 0, MaterialLaw::mooney_rivlin, "mooney_rivlin"},
      {"mu0", c.mu0 != 0, MaterialLaw::fung, "fung"},
      {"mu1", c.mu1 != 0, MaterialLaw::fung, "fung"},
      {"gamma", c.gamma != 0, MaterialLaw::fung, "fung"},
      {"beta1", c.beta1 != 0, MaterialLaw::arruda_boyce, "arruda_boyce"},
      {"beta2", c.beta2 != 0, MaterialLaw::arruda_boyce, "arruda_boyce"},
      {"terms", !c.terms.empty(), MaterialLaw::ogden, "ogden"},
      {"resistance", c.resistance != 0, MaterialLaw::stvk_resistant, "stvk_resistant"},
      {"threshold", c.threshold != 0.1, MaterialLaw::isochoric_extended, "isochoric_extended"},
  };
  for (const GivenConstant& g : list) {
    if (g.given && def.law != g.law) {
      return Error{std::string(g.key) + " belongs to the law " + g.law_name +
                   " and means nothing to the law given; remove it or change \"law\""};
    }
  }
  return {};
}

// Laws with constants of their own take Poisson's ratio from the common ones and nothing else.
Result<void> check_common(const MaterialDef& def, const char* law, bool takes_mu) {
  const ElasticConstants& c = def.constants;
  const char* key = c.young != 0 ? "young" : (c.lambda != -1 ? "lambda" : (c.bulk != -1 ? "bulk" : nullptr));
  if (!key && c.mu != 0 && !takes_mu) key = "mu";
  if (!key && c.bulk_choice != BulkChoice::consistent) key = "bulk_choice";
  if (!key) return {};
  return Error{std::string(law) + ": " + key +
               " is given, but this law takes its own constants and \"poisson\"; remove it"};
}

Result<MaterialPtr> make_native(const MaterialDef& def) {
  const LawConstants& c = def.own;
  const double poisson = def.constants.poisson;
  switch (def.law) {
    case MaterialLaw::mooney_rivlin:
      if (auto r = check_common(def, "mooney_rivlin", false); !r) return Error{r.error()};
      return mooney_rivlin({c.c1, c.c2, poisson});
    case MaterialLaw::fung:
      if (auto r = check_common(def, "fung", false); !r) return Error{r.error()};
      return fung({c.mu0, c.mu1, c.gamma, poisson});
    case MaterialLaw::arruda_boyce:
      if (auto r = check_common(def, "arruda_boyce", true); !r) return Error{r.error()};
      return arruda_boyce({def.constants.mu, c.beta1, c.beta2, poisson});
    case MaterialLaw::ogden:
      if (auto r = check_common(def, "ogden", false); !r) return Error{r.error()};
      return ogden({c.terms, poisson});
    default:
      return Error{"unknown material law"};
  }
}

}  // namespace

static Result<MaterialPtr> make_matrix(const MaterialDef& def) {
  if (auto r = check_constants(def); !r) return Error{r.error()};
  switch (def.law) {
    case MaterialLaw::neo_hookean:
      return neo_hookean(def.constants);
    case MaterialLaw::neo_hookean_ogden:
      return neo_hookean_ogden(def.constants);
    case MaterialLaw::stable_neo_hookean:
      return stable_neo_hookean(def.constants);
    case MaterialLaw::stable_neo_hookean_barrier:
      return stable_neo_hookean_barrier(def.constants);
    case MaterialLaw::isochoric_neo_hookean:
      return isochoric_neo_hookean(def.constants);
    case MaterialLaw::isochoric_extended:
      return isochoric_extended(def.constants, def.own.threshold);
    case MaterialLaw::corotated:
      return corotated(def.constants);
    case MaterialLaw::fixed_corotated:
      return fixed_corotated(def.constants);
    case MaterialLaw::stvk:
      return stvk(def.constants);
    case MaterialLaw::stvk_resistant:
      return stvk_resistant(def.constants, def.own.resistance);
    case MaterialLaw::linear:
      return linear(def.constants);
    default:
      return make_native(def);
  }
}

// The matrix with the fields of its constants.
static Result<MaterialPtr> make_varied(const MaterialDef& def, const std::string& folder) {
  if (!def.poisson_field.given()) return make_matrix(def);
  auto poisson = read_field(def.poisson_field, folder);
  if (!poisson) return Error{"poisson_field: " + poisson.error()};
  const ElasticConstants& c = def.constants;
  if (c.poisson != 0 || c.lambda != -1 || c.bulk != -1) {
    return Error{"poisson_field is given beside " +
                 std::string(c.poisson != 0   ? "poisson"
                             : c.lambda != -1 ? "lambda"
                                              : "bulk") +
                 "; it takes its place, remove one of them"};
  }
  return with_poisson_field(
      [&](double nu) {
        MaterialDef one = def;
        one.constants.poisson = nu;
        return make_matrix(one);
      },
      poisson.value());
}

Result<MaterialPtr> make_material(const MaterialDef& def, const std::string& folder) {
  auto matrix = make_varied(def, folder);
  if (matrix && !def.fibers.empty()) matrix = with_fibers(std::move(matrix).value(), def.fibers);
  const CompressionPenalty& penalty = def.compression_penalty;
  const bool penalized = penalty.modulus != 0 || penalty.beta != CompressionPenalty{}.beta;
  if (matrix && penalized) matrix = with_compression_penalty(std::move(matrix).value(), penalty);
  if (!matrix || !def.stiffness_field.given()) return matrix;
  auto factor = read_field(def.stiffness_field, folder);
  if (!factor) return Error{"stiffness_field: " + factor.error()};
  return with_stiffness_field(std::move(matrix).value(), std::move(factor).value());
}

}  // namespace isochor
