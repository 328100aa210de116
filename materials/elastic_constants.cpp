#include "materials/elastic_constants.h"

#include <cmath>
#include <cstdio>
#include <limits>

namespace isochor {

namespace {

std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.10g", v);
  return text;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Result<LinearElastic> from_young(std::string_view material, const ElasticConstants& c, double lowest) {
  const std::string who(material);
  if (!std::isfinite(c.young) || c.young <= 0) {
    return Error{who + ": young = " + number(c.young) +
                 " Pa; Young's modulus must be a positive number of pascals"};
  }
  if (std::isnan(c.poisson) || c.poisson > 0.5 || c.poisson < lowest) {
    return Error{who + ": poisson = " + number(c.poisson) + "; Poisson's ratio must lie between " +
                 number(lowest) + " and 0.5 for this material (0.5 itself is allowed: incompressible)"};
  }
  LinearElastic e;
  e.young = c.young;
  e.poisson = c.poisson;
  e.mu = c.young / (2 * (1 + c.poisson));
  e.inverse_lambda =
      c.poisson == 0 ? kInfinity : (1 + c.poisson) * (1 - 2 * c.poisson) / (c.young * c.poisson);
  e.inverse_bulk = 3 * (1 - 2 * c.poisson) / c.young;
  return e;
}

}  // namespace

Result<LinearElastic> linear_elastic(std::string_view material, const ElasticConstants& c,
                                     double lowest_poisson) {
  const std::string who(material);
  const bool has_young = c.young != 0 || c.poisson != 0;
  const bool has_mu = c.mu != 0, has_lambda = c.lambda != -1, has_bulk = c.bulk != -1;
  if (has_young && (has_mu || has_lambda || has_bulk)) {
    return Error{who + ": both young/poisson and mu/lambda/bulk are given; give one pair only"};
  }
  if (has_young || !has_mu) return from_young(material, c, lowest_poisson);
  if (!std::isfinite(c.mu) || c.mu <= 0) {
    return Error{who + ": mu = " + number(c.mu) +
                 " Pa; the shear modulus must be a positive number of pascals"};
  }
  if (has_lambda == has_bulk) return Error{who + ": mu needs exactly one of lambda and bulk beside it"};
  LinearElastic e;
  e.mu = c.mu;
  const double given = has_lambda ? c.lambda : c.bulk;
  if (std::isnan(given)) return Error{who + ": lambda or bulk is not a number"};
  const double lambda = has_lambda ? c.lambda : c.bulk - 2 * c.mu / 3;
  if (has_bulk && c.bulk <= 0) return Error{who + ": bulk = " + number(c.bulk) + " Pa; it must be positive"};
  e.poisson = std::isinf(given) ? 0.5 : lambda / (2 * (lambda + c.mu));
  if (e.poisson < lowest_poisson) {
    return Error{who + ": " + (has_lambda ? "lambda" : "bulk") + " = " + number(given) +
                 " Pa gives Poisson's ratio " + number(e.poisson) + ", below " + number(lowest_poisson) +
                 ", the least this material takes"};
  }
  e.young = 2 * c.mu * (1 + e.poisson);
  e.inverse_lambda = std::isinf(given) ? 0 : (lambda == 0 ? kInfinity : 1 / lambda);
  e.inverse_bulk = std::isinf(given) ? 0 : 1 / (lambda + 2 * c.mu / 3);
  return e;
}

Error one_field_incompressible(std::string_view material) {
  return Error{
      std::string(material) +
      ": a one-field formulation cannot take Poisson's ratio 0.5, because its volumetric stiffness would be "
      "infinite; use volume rows (volume = \"node\" or another space) or a smaller ratio"};
}

}  // namespace isochor
