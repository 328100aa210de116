// Results per cell and node that are not unknowns: J, Cauchy stress, mean stress.
#pragma once

#include "engine/scene/builder.h"

namespace isochor {

struct RecoveryInput {
  const BodyData& body;
  const SystemParts& parts;
  std::span<const Vec3> x;
  // Multiplier of every volume function, by stencil pool: [pool][stencil * functions + k].
  std::span<const std::span<const double>> function_multiplier;
  // Multipliers of nodal rows by scene node, NaN where there is none: smoother than what cells give back.
  std::span<const double> node_multiplier;
  // What pools keep between steps, by stencil pool; empty: nothing.
  std::span<const std::span<const double>> memory;
  double t = 0;  // of the state [s]
};

// Cauchy stress of the energy plus the pressure of the rows. Edge-smoothed cells take the mean of the
// stresses of their six edge patches. Nodes take a linear fit to the points (or patches) around them.
BodyFields recover_fields(const RecoveryInput& in);

// Volume now and at rest, and the extremes of J over cells (over points for Tet10).
BodyMeasures measure_body(const BodyData& body, const SystemParts& parts, std::span<const Vec3> x);

}  // namespace isochor
