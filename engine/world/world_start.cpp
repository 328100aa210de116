#include <algorithm>
#include <cmath>

#include "engine/base/out_of_memory.h"
#include "engine/step/time_scheme.h"
#include "engine/world/world_impl.h"

namespace isochor {

namespace {

Result<void> check_nodes(const char* call, const char* what, const BodyData& body,
                         std::span<const Vec3> values) {
  if (values.size() != body.mesh.nodes.size()) {
    return Error{std::string(call) + ": " + std::to_string(values.size()) + " " + what + " for the " +
                 std::to_string(body.mesh.nodes.size()) + " nodes of body \"" + body.name +
                 "\"; give one a node"};
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i].x + values[i].y + values[i].z)) continue;
    return Error{std::string(call) + ": of the " + what + ", that of node " + std::to_string(i) +
                 " of body \"" + body.name + "\" is not a finite number"};
  }
  return {};
}

}  // namespace

Result<void> World::set_velocities(BodyId body, std::span<const Vec3> velocities) try {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return r;
  if (auto r = check(body); !r) return Error{"set_velocities: " + r.error()};
  if (!w.options.scheme->has_inertia()) {
    return Error{"set_velocities: the scheme of this world is " + std::string(w.options.scheme->name()) +
                 ", in which nothing has a velocity; use a scheme of dynamics"};
  }
  w.settled.reset();  // what a host sets is where it wants to go on from
  const BodyData& b = w.said.builder.body(body);
  if (auto r = check_nodes("set_velocities", "velocities", b, velocities); !r) return r;
  std::copy(velocities.begin(), velocities.end(), w.state.v.begin() + b.first_node);
  const auto past = w.layout.of_scheme(w.state.extra);
  std::fill(past.begin(), past.end(), 0.0);
  return {};
} catch (const std::bad_alloc&) {
  return no_memory("set_velocities");
}

Result<void> World::set_positions(BodyId body, std::span<const Vec3> positions) try {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return r;
  if (auto r = check(body); !r) return Error{"set_positions: " + r.error()};
  w.settled.reset();  // what a host sets is where it wants to go on from
  const BodyData& b = w.said.builder.body(body);
  if (auto r = check_nodes("set_positions", "positions", b, positions); !r) return r;
  const auto first = at(b.first_node);
  std::copy(positions.begin(), positions.end(), w.state.x.begin() + static_cast<std::ptrdiff_t>(first));
  std::fill_n(w.state.v.begin() + static_cast<std::ptrdiff_t>(first), positions.size(), Vec3{});
  std::fill(w.state.lambda.begin(), w.state.lambda.end(), 0.0);
  // Stencils and the scheme have no past either.
  for (const auto& stencils : w.system().facets().remembering) {
    const auto kept = stencils.in(std::span(w.state.extra));
    std::fill(kept.begin(), kept.end(), 0.0);
  }
  const auto past = w.layout.of_scheme(w.state.extra);
  std::fill(past.begin(), past.end(), 0.0);
  return {};
} catch (const std::bad_alloc&) {
  return no_memory("set_positions");
}

}  // namespace isochor
