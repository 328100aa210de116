#include "engine/elements/volume_strain.h"

#include <cmath>
#include <limits>

namespace isochor {

namespace {

// Phi = d sqrt(s) with d = J - 1 and s = (J^2 - 1 - 2 log J)/(2 d^2) = 1 - d/3 + d^2/4 - d^3/5 + ...
VolumeResponse mixed_response(double d) {
  const double J = 1 + d;
  double s = 0, slope = 0;  // s and ds/dJ
  if (std::abs(d) < 0.0625) {
    for (int k = 13; k >= 1; --k) {
      slope = slope * d + s;
      s = s * d + (k % 2 == 1 ? 1.0 : -1.0) / (k == 1 ? 1 : k + 1);
    }
  } else {
    const double twice = d * (2 + d) - 2 * std::log1p(d);
    s = twice / (2 * d * d);
    slope = ((2 + d) / J - 2 * s) / d;
  }
  const double root = std::sqrt(s), first = (2 + d) / (2 * J * root);
  return {d * root, first, first * (1 / (2 + d) - 1 / J - slope / (2 * s))};
}

}  // namespace

VolumeResponse volume_response(VolumeStrain strain, double j_minus_1) {
  if (!has_logarithm(strain)) return {j_minus_1, 1, 0};
  const double J = 1 + j_minus_1;
  if (J <= 0) return {-std::numeric_limits<double>::infinity(), 0, 0};
  if (strain == VolumeStrain::mixed || strain == VolumeStrain::mean_mixed) return mixed_response(j_minus_1);
  return {std::log1p(j_minus_1), 1 / J, -1 / (J * J)};
}

}  // namespace isochor
