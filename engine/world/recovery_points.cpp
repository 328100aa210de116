#include "engine/world/recovery_points.h"

#include <cmath>

#include "engine/elements/relaxation_pool.h"
#include "engine/elements/volume_strain.h"

namespace isochor {

using Matrix = StressMatrix;

// What Cauchy stresses are divided by. A law that lives through inversion may leave a cell without any
// volume, where they have no value: theirs is then that of the least volume that rounding leaves.
static double divisor(double J) {
  constexpr double least = 1e-15;
  return std::abs(J) < least ? std::copysign(least, J) : J;
}

PointState point_state(const SolidPool& pool, const Material* energy, Index stencil, Index element, int q,
                       const RecoveryInput& in, const GrownState* grown, double kept) {
  PointState p;
  double F[9], strain = 0;
  pool.deformation_gradient(stencil, q, in.x, in.parts.rest, F, strain);
  p.F = Eigen::Map<const Matrix>(F);
  p.J = 1 + strain;
  p.elastic = p.F;
  p.elastic_J = p.J;
  if (grown) {
    p.elastic = p.F * Eigen::Map<const Matrix>(grown->inverse);
    p.elastic_J = p.J / grown->J;
  }
  p.weight = pool.data().weight[at(stencil * pool.data().points + q)];
  if (!energy) return p;
  PointBatch batch;
  ResponseBatch response;
  for (int l = 0; l < kLanes; ++l) {
    for (int i = 0; i < 9; ++i) batch.F[i][l] = p.elastic(i / 3, i % 3);
    batch.element[l] = element;
    batch.kept[l] = kept;
  }
  energy->evaluate(Want::gradient, batch, response);
  Matrix P;
  for (int i = 0; i < 9; ++i) P(i / 3, i % 3) = response.P[i][0];
  p.stress = P * p.elastic.transpose() / divisor(p.elastic_J);
  return p;
}

double kept_of(const RecoveryInput& in, const RegionData& region, Index stencil, int q) {
  if (!region.energy || !region.energy->remembers()) return 0;
  const auto& pool = static_cast<const SolidPool&>(*in.parts.stencil_pools[at(region.elastic_pool)]);
  return pool.kept(in.memory[at(region.elastic_pool)], stencil, q);
}

Matrix memory_stress(const RecoveryInput& in, const RegionData& region, Index stencil, int q,
                     const PointState& p) {
  Matrix P = Matrix::Zero();
  for (const Index m : region.memory_pools) {
    const auto& branch = static_cast<const RelaxationPool&>(*in.parts.stencil_pools[at(m)]);
    double share[9];
    branch.stress(stencil, q, in.x, in.parts.rest, in.memory[at(m)], share);
    P += Eigen::Map<const Matrix>(share);
  }
  return P * p.F.transpose() / divisor(p.J);
}

namespace {

double multiplier_at(const RecoveryInput& in, Index pool, Index stencil, int q) {
  const SolidData& data = static_cast<const SolidPool&>(*in.parts.stencil_pools[at(pool)]).data();
  double sum = 0;
  for (int k = 0; k < data.functions; ++k) {
    sum += data.shape[static_cast<std::size_t>(q * data.functions + k)] *
           in.function_multiplier[at(pool)][at(stencil * data.functions + k)];
  }
  return sum;
}

// The pressure that the multiplier of a strain makes at a point with volume ratio J.
double pressure_of(const RecoveryInput& in, Index pool, VolumeStrain strain, Index stencil, int q, double J,
                   const GrownState* grown) {
  const double multiplier = multiplier_at(in, pool, stencil, q) / (grown ? std::sqrt(grown->J) : 1);
  if (!has_logarithm(strain)) return multiplier;
  const auto& solid = static_cast<const SolidPool&>(*in.parts.stencil_pools[at(pool)]);
  if (strain == VolumeStrain::logarithmic) return multiplier / divisor(J);
  double d = J - 1;
  if (is_of_mean(strain)) {
    d = solid.mean_volume_strain(stencil, in.x, in.parts.rest);
    if (grown) d = (d - (grown->J - 1)) / grown->J;
  }
  return multiplier * volume_response(strain, d).first;
}

}  // namespace

double row_pressure(const RecoveryInput& in, const RegionData& region, Index local, int q, double J,
                    const GrownState* grown) {
  double p = 0;
  for (std::size_t strain = 0; strain < kVolumeStrains; ++strain) {
    const Index pool = region.volume_pool[strain];
    if (pool >= 0) p += pressure_of(in, pool, static_cast<VolumeStrain>(strain), local, q, J, grown);
  }
  for (const SpanningVolume& v : in.body.spanning) {
    const Index stencil = v.stencil_of_cell[at(region.cells[at(local)])];
    if (stencil >= 0) p += pressure_of(in, v.pool, v.strain, stencil, q, J, grown);
  }
  return p;
}

}  // namespace isochor
