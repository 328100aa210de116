#include <algorithm>
#include <cmath>

#include "engine/world_impl.h"

namespace isochor {

Result<void> World::set_positions(BodyId body, std::span<const Vec3> positions) {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return r;
  if (!w.builder.has_body(body)) {
    return Error{"set_positions: there is no body number " + std::to_string(static_cast<Index>(body))};
  }
  const BodyData& b = w.builder.body(body);
  if (positions.size() != b.mesh.nodes.size()) {
    return Error{"set_positions: " + std::to_string(positions.size()) + " positions for the " +
                 std::to_string(b.mesh.nodes.size()) + " nodes of body \"" + b.name + "\"; give one a node"};
  }
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (std::isfinite(positions[i].x + positions[i].y + positions[i].z)) continue;
    return Error{"set_positions: the position of node " + std::to_string(i) + " of body \"" + b.name +
                 "\" is not a finite number"};
  }
  const auto first = at(b.first_node);
  std::copy(positions.begin(), positions.end(), w.state.x.begin() + static_cast<std::ptrdiff_t>(first));
  std::fill_n(w.state.v.begin() + static_cast<std::ptrdiff_t>(first), positions.size(), Vec3{});
  std::fill(w.state.lambda.begin(), w.state.lambda.end(), 0.0);
  // Stencils and the scheme have no past either.
  for (Index p = 0; p < static_cast<Index>(w.system->parts().stencil_pools.size()); ++p) {
    const auto kept = w.state.extra.begin() + w.system->first_stencil_memory(p);
    std::fill_n(kept, w.system->parts().stencil_pools[at(p)]->memory(), 0.0);
  }
  const auto past = w.scheme_memory();
  std::fill(past.begin(), past.end(), 0.0);
  return {};
}

}  // namespace isochor
