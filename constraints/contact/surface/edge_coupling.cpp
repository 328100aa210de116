// How the friction of EdgeContactPool changes with what it holds on to: the normal force and its weight, the
// nearest places and the common normal, and the edge that the pull kept turns with.
#include <algorithm>

#include "constraints/contact/friction/turning_frame.h"
#include "constraints/contact/surface/edge_contact_pool.h"

namespace isochor {

Vec3 EdgeContactPool::kept_pull_rate(Index s, std::span<const double> memory, std::span<const Vec3> x,
                                     std::size_t node, const Vec3& rate) const {
  if (memory.empty() || node >= kEdgeNodes) return {};
  const double* m = memory.data() + static_cast<std::size_t>(memory_per_edge()) * at(s);
  if (m[1] == 0 && m[2] == 0 && m[3] == 0) return {};
  const auto& n = (*setup_->edges)[s].node;
  std::array<Vec3, kEdgeNodes> way{}, way_rate{};  // from the start of the edge
  for (std::size_t k = 1; k < kEdgeNodes; ++k) {
    way[k] = x[at(n[k])] - x[at(n[0])];
    if (node == 0 || node == k) way_rate[k] = node == 0 ? -rate : rate;
  }
  const Vec3 beside = way[2] - way[3], out = cross(way[1], beside);
  return turning_rate(way[1], way_rate[1], out,
                      cross(way_rate[1], beside) + cross(way[1], way_rate[2] - way_rate[3]),
                      {m[1], m[2], m[3]});
}

void EdgeContactPool::lag_derivatives(const StencilRequest& q, const LagSlots& slots) const {
  for (Index s = q.begin; s < q.end; ++s) {
    const auto nodes = nodes_[s];
    const std::size_t n = nodes.size();
    Mat3* blocks = slots.block.data() + slots.block_offset[at(s)];
    Vec3* column = slots.column.data() + nodes_.offset[at(s)];
    if (!has_partner(s) || q.lag.x.empty()) continue;
    const Friction f = friction(q, s);
    if (!(f.spring.limit > 0)) continue;
    const EdgeRates rates = edge_rates(places(s, q.lag.x), f.gap);
    const Vec3 pull = f.spring.pull(), by_limit = f.spring.pull_by_limit();
    for (std::size_t a = 0; a < n; ++a) column[a] = -f.mu * f.gap.weight * f.gap.share(a) * by_limit;
    // What the nearest places move by along their edges slides over.
    std::array<Vec3, 2> slide{};
    for (std::size_t a = 0; a < n && !q.increment.before.empty(); ++a)
      slide[a / kEdgeNodes] +=
          EdgeGap::share_slope(a) * (q.x[at(nodes[a])] - q.increment.before[at(nodes[a])]);
    const double force_of_weight = f.spring.limit / f.gap.weight;
    for (std::size_t b = 0; b < n; ++b) {
      for (int e = 0; e < 3; ++e) {
        Vec3 along{};
        along[e] = 1;
        Vec3 whole_rate = (1 / f.spring.stiffness) * kept_pull_rate(s, q.memory, q.lag.x, b, along);
        for (std::size_t t = 0; t < 2; ++t) whole_rate += rates.place[t][b][e] * slide[t];
        const Vec3 by_node = f.spring.pull_rate(f.whole, whole_rate, rates.normal[b] * along) +
                             (force_of_weight * rates.weight[b][e]) * by_limit;
        for (std::size_t a = 0; a < n; ++a) {
          const double share_rate = EdgeGap::share_slope(a) * rates.place[a / kEdgeNodes][b][e];
          const Vec3 force = f.gap.share(a) * by_node + share_rate * pull;
          for (int i = 0; i < 3; ++i) blocks[a * n + b](i, e) = force[i];
        }
      }
    }
  }
}

}  // namespace isochor
