// Stresses in points of the stencils that energies and volume rows are of, as recover_fields() gathers them.
#pragma once

#include <Eigen/Dense>

#include "engine/elements/growth.h"
#include "engine/world/recovery.h"

namespace isochor {

using StressMatrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

struct PointState {
  StressMatrix F = StressMatrix::Identity(), elastic = F;  // F, and F_e of what has grown
  double J = 1, elastic_J = 1, weight = 0;
  StressMatrix stress = StressMatrix::Zero();  // Cauchy, of the energy alone
};

// `stencil` of the pool; `element` of the energy, which may be of another pool.
PointState point_state(const SolidPool& pool, const Material* energy, Index stencil, Index element, int q,
                       const RecoveryInput& in, const GrownState* grown, double kept);
// What a point of the stencils of the energy keeps.
double kept_of(const RecoveryInput& in, const RegionData& region, Index stencil, int q);
// Cauchy stress of what flows at a point of the stencils of the energy.
StressMatrix memory_stress(const RecoveryInput& in, const RegionData& region, Index stencil, int q,
                           const PointState& p);
// Mean pressure of the volume rows over a point; `local` is the number of its cell in the region.
double row_pressure(const RecoveryInput& in, const RegionData& region, Index local, int q, double J,
                    const GrownState* grown);

}  // namespace isochor
