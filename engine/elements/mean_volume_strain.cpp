// Volume strains of the mean of J over a cell. In a file of its own: what pools without them compute stays,
// to the bit, what it is without this code beside it.
#include "engine/elements/solid_point.h"
#include "engine/elements/solid_pool.h"
#include "engine/elements/volume_strain.h"

namespace isochor {

double SolidPool::mean_volume_strain(Index stencil, std::span<const Vec3> x,
                                     std::span<const Vec3> rest) const {
  double sum = 0, size = 0;
  for (int q = 0; q < data_.points; ++q) {
    const double w = data_.weight[at(stencil * data_.points + q)];
    double F[9], strain;
    deformation_gradient(stencil, q, x, rest, F, strain);
    sum += w * strain;
    size += w;
  }
  return sum / size;
}

// Of Phi(mean J): with v = integral of J - 1 over a cell of volume V the row is V Phi(v/V), whose second
// derivative has Phi''/V dv dv^T beside Phi' d2v. The Jacobian in the slots is Phi' dv.
void SolidPool::add_bending_of_mean(const StencilRequest& request, const StencilSlots& slots) const {
  for (Index s = request.begin; s < request.end; ++s) {
    const double multiplier = request.function_multiplier[at(s)];
    const VolumeResponse phi = volume_response(strain_, mean_volume_strain(s, request.x, request.rest));
    if (multiplier == 0 || phi.first == 0) continue;
    double c = multiplier * phi.second / (volume(s) * phi.first * phi.first);
    if (request.definiteness != Definiteness::exact && c < 0)
      c = request.definiteness == Definiteness::absolute ? -c : 0;
    const std::size_t n = nodes_[s].size();
    const Vec3* d = slots.jacobian.data() + at(nodes_.offset[at(s)]);
    add_outer_products(c, d, n, slots.hessian.data() + hessian_offset()[at(s)]);
  }
}

}  // namespace isochor
