// Friction as an energy of the slip, with the normal force and the tangent plane held.
#pragma once

#include <algorithm>
#include <cmath>

#include "engine/base/base.h"

namespace isochor {

// Coulomb's coefficients [-]. Where breaking away takes more than sliding, a point has for a whole step the
// one that its last step ended with: the kinetic one when it slipped, else, and where it did not touch, the
// static one.
struct FrictionLaw {
  double kinetic = 0, breakaway = 0;  // breakaway >= kinetic
  FrictionLaw() = default;
  FrictionLaw(double mu) : kinetic(mu), breakaway(mu) {}
  FrictionLaw(double mu, double static_mu) : kinetic(mu), breakaway(std::max(mu, static_mu)) {}

  bool any() const { return breakaway > 0; }
  // Numbers that a point keeps between steps: whether it slipped.
  int memory() const { return breakaway > kinetic ? 1 : 0; }
  double coefficient(const double* kept) const {
    return memory() > 0 && kept != nullptr && *kept != 0 ? kinetic : breakaway;
  }
};

// k/2 |z|^2 where k |z| <= mu N, else mu N |z| - (mu N)^2 / (2 k): convex and once differentiable in z.
struct FrictionSpring {
  double stiffness = 0;  // k of friction that sticks [N/m]
  double limit = 0;      // mu N [N]
  Vec3 normal{}, z{};    // unit normal; slip, with what the last step left of the pull over k, across it [m]

  double stretch() const { return std::sqrt(dot(z, z)); }
  bool slips() const { return limit > 0 && !sticks(); }
  bool sticks() const { return stiffness * stretch() <= limit; }
  double energy() const {
    const double s = stretch();
    return sticks() ? 0.5 * stiffness * s * s : limit * s - 0.5 * limit * limit / stiffness;
  }
  // Derivative in z [N].
  Vec3 pull() const { return sticks() ? stiffness * z : (limit / stretch()) * z; }
  // Derivative of the pull in the limit [-].
  Vec3 pull_by_limit() const { return sticks() ? Vec3{} : (1 / stretch()) * z; }
  // Rate of the pull where `whole`, of which z is the part across the normal, and the normal change at the
  // given rates.
  Vec3 pull_rate(const Vec3& whole, const Vec3& whole_rate, const Vec3& normal_rate) const {
    const Vec3 z_rate = whole_rate - (dot(whole, normal_rate) + dot(whole_rate, normal)) * normal -
                        dot(whole, normal) * normal_rate;
    if (sticks()) return stiffness * z_rate;
    const double s = stretch();
    return (limit / s) * (z_rate - (dot(z, z_rate) / (s * s)) * z);
  }
  // Second derivative: sticking, k in the tangent plane; slipping, only across the direction of the slip.
  Mat3 curvature() const {
    const double s = stretch(), k = sticks() ? stiffness : limit / s;
    Mat3 plane;
    for (int i = 0; i < 3; ++i) {
      plane(i, i) = k;
      for (int j = 0; j < 3; ++j) {
        plane(i, j) -= k * normal[i] * normal[j];
        if (!sticks()) plane(i, j) -= k / (s * s) * z[i] * z[j];
      }
    }
    return plane;
  }
};

}  // namespace isochor
