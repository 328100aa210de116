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

}  // namespace isochor
