#include "constraints/contact_rows.h"

#include <algorithm>
#include <cmath>

namespace isochor {

// With f the force over that at the knee: depth over the one there is f up to 1 and (1 - e)(2 - 1/f) + e f
// beyond, whose slope (1 - e)/f^2 + e goes on from 1. The trace e keeps rows that repeat each other solvable.
double ContactRows::evaluate_law(const RowIncrement&, std::span<const double> lambda,
                                 std::span<double> strain, std::span<double> tangent) const {
  constexpr double trace = 1e-3;
  double potential = 0;
  for (std::size_t r = 0; r < lambda.size(); ++r) {
    const double soft = compliance[r].value, most = knee[r];
    const double f = -lambda[r] / most;
    if (!(f > 1)) {
      strain[r] = soft * lambda[r];
      if (!tangent.empty()) tangent[r] = soft;
      potential += 0.5 * soft * lambda[r] * lambda[r];
      continue;
    }
    strain[r] = -soft * most * ((1 - trace) * (2 - 1 / f) + trace * f);
    if (!tangent.empty()) tangent[r] = soft * ((1 - trace) / (f * f) + trace);
    potential +=
        soft * most * most * (0.5 + (1 - trace) * (2 * (f - 1) - std::log(f)) + 0.5 * trace * (f * f - 1));
  }
  return potential;
}

}  // namespace isochor
