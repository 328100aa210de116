// Quantities over time.
#pragma once

#include <array>
#include <vector>

#include "isochor/export.h"

namespace isochor {

// A quantity over time (seconds; in statics the load factor): piecewise linear through the points, constant
// outside.
struct Curve {
  std::vector<std::array<double, 2>> points;  // (time, value), times ascending
  static Curve constant(double value) { return {{{0, value}}}; }
  static Curve ramp(double value, double end = 1) { return {{{0, 0}, {end, value}}}; }
};
ISOCHOR_API double evaluate(const Curve& curve, double t);

}  // namespace isochor
