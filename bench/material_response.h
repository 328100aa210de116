// Homogeneous states of a material: what a block of it answers when it is pulled, spread, sheared or swollen.
// Stresses are nominal (force over area at rest), directions that are not held are free of stress.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "engine/elements/material_model.h"
#include "isochor/materials.h"

namespace isochor::response {

struct Point {
  double P[9] = {}, A[45] = {};
  double at(int i, int j) const { return A[i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i]; }
};

// Not a number where the energy has no value.
inline Point evaluate(const Material& energy, const std::array<double, 9>& F) {
  PointBatch batch{};
  ResponseBatch r;
  for (std::size_t i = 0; i < 9; ++i) {
    for (int l = 0; l < kLanes; ++l) batch.F[i][l] = F[i];
  }
  energy.evaluate(Want::hessian, batch, r);
  Point p;
  const bool valued = std::isfinite(r.psi[0]);
  for (int i = 0; i < 9; ++i) p.P[i] = valued ? r.P[i][0] : std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < 45; ++i) p.A[i] = r.A[i][0];
  return p;
}

// A block of one material: of its complete energy, or incompressible with its distortional one.
struct Block {
  std::shared_ptr<const Material> energy;
  bool incompressible = false;

  static std::optional<Block> of(const MaterialModel& model) {
    if (model.inverse_bulk() == 0) return Block{model.distortional(), true};
    auto complete = model.complete();
    if (!complete) return std::nullopt;
    return Block{complete.value(), false};
  }

  // Nominal stress along x at the stretches (a, b, c), where the last direction is free: its stretch is found
  // (compressible, from the guess in c, which keeps the answer) or follows (incompressible).
  double along_x(double a, double& b, double& c, bool b_is_free) const {
    if (incompressible) {
      c = b_is_free ? 1 / std::sqrt(a) : 1 / (a * b);
      if (b_is_free) b = c;
      const Point p = evaluate(*energy, {a, 0, 0, 0, b, 0, 0, 0, c});
      // The pressure that frees the last direction: P - q F^-T.
      return p.P[0] - p.P[8] * c / a;
    }
    // A state on another branch than the guess is none that the block comes to: it gives way in between.
    const double guess = c;
    for (int i = 0; i < 60; ++i) {
      if (b_is_free) b = c;
      const Point p = evaluate(*energy, {a, 0, 0, 0, b, 0, 0, 0, c});
      if (!std::isfinite(p.P[8])) return std::numeric_limits<double>::quiet_NaN();
      const double slope = p.at(8, 8) + (b_is_free ? p.at(8, 4) : 0);
      const double step = slope > 0 ? -p.P[8] / slope : (p.P[8] > 0 ? -0.1 * c : 0.1 * c);
      c += std::abs(step) > 0.3 * c ? std::copysign(0.3 * c, step) : step;
      if (std::abs(step) < 1e-13 * c) break;
      if (i == 59) return std::numeric_limits<double>::quiet_NaN();
    }
    if (std::abs(c - guess) > 0.25 * guess) return std::numeric_limits<double>::quiet_NaN();
    if (b_is_free) b = c;
    return evaluate(*energy, {a, 0, 0, 0, b, 0, 0, 0, c}).P[0];
  }
};

// Pulled along x, the sides free. `side` is the stretch of the sides: a guess, then the answer.
inline double uniaxial(const Block& block, double stretch, double& side) {
  double other = side;
  return block.along_x(stretch, other, side, true);
}

// Pulled alike along x and y, z free.
inline double equibiaxial(const Block& block, double stretch, double& side) {
  double y = stretch;
  return block.along_x(stretch, y, side, false);
}

// Pulled along x at constant length along y, z free: pure shear.
inline double pure_shear(const Block& block, double stretch, double& side) {
  double y = 1;
  return block.along_x(stretch, y, side, false);
}

// Sheared by gamma at constant height: the shear stress.
inline double simple_shear(const Block& block, double gamma) {
  return evaluate(*block.energy, {1, gamma, 0, 0, 1, 0, 0, 0, 1}).P[1];
}

// The same stretch in every direction: tr sigma / 3 at the volume ratio J.
inline double volumetric(const Block& block, double J) {
  const double s = std::cbrt(J);
  const Point p = evaluate(*block.energy, {s, 0, 0, 0, s, 0, 0, 0, s});
  return (p.P[0] + p.P[4] + p.P[8]) / (3 * s * s);
}

}  // namespace isochor::response
