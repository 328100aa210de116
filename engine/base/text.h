// Numbers in messages: as few digits as tell them apart from their neighbors at a glance, whatever their
// size.
#pragma once

#include <cstdio>
#include <string>

namespace isochor {

// At most six significant digits, exponents where they are shorter: 0.25, 1e-09, 3.6e+300, inf.
inline std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

}  // namespace isochor
