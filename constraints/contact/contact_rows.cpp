#include "constraints/contact/contact_rows.h"

#include <algorithm>
#include <cmath>

namespace isochor {

namespace {

// Of a row that stiffens, at f > 1 times the force at the knee, over those there: (1 - e)(2 - 1/f) + e f for
// the depth, whose slope (1 - e)/f^2 + e goes on from that of the linear part. The trace e keeps rows that
// repeat each other solvable.
constexpr double kTrace = 1e-3;
double depth_beyond(double f) {
  return (1 - kTrace) * (2 - 1 / f) + kTrace * f;
}

}  // namespace

double ContactRows::evaluate_law(const RowIncrement&, std::span<const double> lambda,
                                 std::span<double> strain, std::span<double> tangent) const {
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
    strain[r] = -soft * most * depth_beyond(f);
    if (!tangent.empty()) tangent[r] = soft * ((1 - kTrace) / (f * f) + kTrace);
    potential +=
        soft * most * most * (0.5 + (1 - kTrace) * (2 * (f - 1) - std::log(f)) + 0.5 * kTrace * (f * f - 1));
  }
  return potential;
}

double ContactRows::depth(Index row, double multiplier) const {
  if (compliance.empty() || !(multiplier < 0)) return 0;
  const double soft = compliance[at(row)].value;
  if (knee.empty() || !(-multiplier > knee[at(row)])) return -soft * multiplier;
  return soft * knee[at(row)] * depth_beyond(-multiplier / knee[at(row)]);
}

}  // namespace isochor
