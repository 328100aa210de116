#include "constraints/stencil/point_pool.h"

#include <algorithm>

namespace isochor {

void PointPool::evaluate(const StencilRequest& q, const StencilSlots& slots) const {
  for (Index s = q.begin; s < q.end; ++s) {
    const auto nodes = nodes_[s];
    const std::size_t n = nodes.size(), first = at(nodes_.offset[at(s)]);
    const Frame& frame = frame_[at(s)];
    Vec3 moved{};
    for (std::size_t a = 0; a < n; ++a) {
      moved += weight_[first + a] * (q.x[at(nodes[a])] - q.rest[at(nodes[a])]);
    }
    slots.energy[at(s)] = 0;
    Vec3 force{};
    for (std::size_t k = 0; k < 3; ++k) {
      slots.value[3 * at(s) + k] = dot(frame[k], moved);
      if (q.want != Want::value) force += q.function_multiplier[3 * at(s) + k] * frame[k];
    }
    if (q.want == Want::value) continue;
    for (std::size_t a = 0; a < n; ++a) {
      slots.gradient[first + a] = weight_[first + a] * force;
      for (std::size_t k = 0; k < 3; ++k)
        slots.jacobian[3 * first + k * n + a] = weight_[first + a] * frame[k];
    }
    if (q.want != Want::hessian) continue;
    const auto block = static_cast<std::size_t>(hessian_offset()[at(s)]);
    std::fill_n(slots.hessian.begin() + static_cast<std::ptrdiff_t>(block), n * (n + 1) / 2, Mat3{});
  }
}

}  // namespace isochor
