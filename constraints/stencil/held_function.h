// Functions c . x of a stencil whose c is held where the iteration began.
#pragma once

#include "engine/system/pool.h"

namespace isochor {

// The slots of stencil `s`: value c . (x - origin), the Jacobian c. Linear in the positions; the places of
// the Hessian are for what the lag adds. `origin(a)`: of the a-th node [m].
template <class Origin>
void write_held_function(const StencilRequest& request, const StencilSlots& slots, const StencilPool& pool,
                         Index s, const Vec3* c, Origin origin) {
  const auto nodes = pool.nodes()[s];
  const std::size_t n = nodes.size(), first = at(pool.nodes().offset[at(s)]);
  slots.energy[at(s)] = 0;
  double value = 0;
  for (std::size_t a = 0; a < n; ++a) value += dot(c[a], request.x[at(nodes[a])] - origin(a));
  slots.value[at(s)] = value;
  if (request.want == Want::value) return;
  const double multiplier = request.function_multiplier[at(s)];
  for (std::size_t a = 0; a < n; ++a) {
    slots.jacobian[first + a] = c[a];
    slots.gradient[first + a] = multiplier * c[a];
  }
  if (request.want == Want::hessian)
    std::fill_n(slots.hessian.data() + pool.hessian_offset()[at(s)], n * (n + 1) / 2, Mat3{});
}

}  // namespace isochor
