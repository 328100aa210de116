#include "materials/native_constants.h"

#include <cmath>
#include <cstdio>

namespace isochor {

namespace {

std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.10g", v);
  return text;
}

}  // namespace

Result<void> not_negative(std::string_view material, const char* key, double value) {
  if (value >= 0 && std::isfinite(value)) return {};
  return Error{std::string(material) + ": " + key + " = " + number(value) +
               "; it must be a number that is not negative, or the material would soften or swell by itself"};
}

Result<LinearElastic> small_strain(std::string_view material, const char* formula, double shear_modulus,
                                   double poisson, double lowest_poisson) {
  if (!(shear_modulus > 0) || !std::isfinite(shear_modulus)) {
    return Error{std::string(material) + ": the shear modulus at small strain, " + formula + " = " +
                 number(shear_modulus) + " Pa, must be a positive number of pascals"};
  }
  ElasticConstants c;
  c.young = 2 * shear_modulus * (1 + poisson);
  c.poisson = poisson;
  auto e = linear_elastic(material, c, lowest_poisson);
  if (e) e.value().mu = shear_modulus;
  return e;
}

}  // namespace isochor
