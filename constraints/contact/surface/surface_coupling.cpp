// How the friction of SurfaceContactPool changes with what it holds on to: the normal force, the nearest
// place and the tangent plane there, and the triangle that the pull kept turns with.
#include <algorithm>
#include <cmath>

#include "constraints/contact/friction/turning_frame.h"
#include "constraints/contact/surface/surface_contact_pool.h"

namespace isochor {

// As the axes of the triangle turn when `node` moves.
Vec3 SurfaceContactPool::kept_pull_rate(Index s, std::span<const double> memory, std::span<const Vec3> x,
                                        Index node, const Vec3& rate) const {
  if (memory.empty()) return {};
  const double* m = memory.data() + static_cast<std::size_t>(memory_per_point()) * at(s);
  if (m[1] == 0 && m[2] == 0 && m[3] == 0) return {};
  const auto& c = setup_->skin->corners(setup_->skin->triangles_at(s)[0]);
  const Vec3 u = x[at(c[1])] - x[at(c[0])], v = x[at(c[2])] - x[at(c[0])], area = cross(u, v);
  Vec3 u_rate{}, v_rate{};
  if (node == c[0]) u_rate = v_rate = -rate;
  if (node == c[1]) u_rate = rate;
  if (node == c[2]) v_rate = rate;
  return turning_rate(u, u_rate, area, cross(u_rate, v) + cross(u, v_rate), {m[1], m[2], m[3]});
}

void SurfaceContactPool::lag_derivatives(const StencilRequest& q, const LagSlots& slots) const {
  for (Index s = q.begin; s < q.end; ++s) {
    const auto nodes = nodes_[s];
    const std::size_t n = nodes.size();
    Mat3* blocks = slots.block.data() + slots.block_offset[at(s)];
    Vec3* column = slots.column.data() + nodes_.offset[at(s)];
    if (!close(s) || q.lag.x.empty()) continue;
    const Friction f = friction(q, s);
    if (!(f.spring.limit > 0) || !std::isfinite(f.near.distance)) continue;
    const Vec3 pull = f.spring.pull(), by_multiplier = -f.mu * f.spring.pull_by_limit();
    for (std::size_t a = 0; a < n; ++a) column[a] = share(s, a, f.near) * by_multiplier;
    const std::size_t first = setup_->skin->points()[at(s)].nodes, of_gap = gap_nodes(s);
    // What the nearest place moves by along its coordinates slides over.
    std::array<Vec3, 2> slide{};
    for (std::size_t a = 0; a < f.near.dimensions && !q.increment.before.empty(); ++a) {
      for (std::size_t k = first; k < of_gap; ++k)
        slide[a] -= f.near.slope[a][k - first] * (q.x[at(nodes[k])] - q.increment.before[at(nodes[k])]);
    }
    for (std::size_t b = 0; b < n; ++b) {
      const std::size_t place = b < first ? kPatchNodes : b - first;
      const PatchRate rate = b < of_gap ? patch_rate(f.near, share(s, b, f.near), place) : PatchRate{};
      for (int e = 0; e < 3; ++e) {
        Vec3 along{};
        along[e] = 1;
        Vec3 whole_rate = (1 / f.spring.stiffness) * kept_pull_rate(s, q.memory, q.lag.x, nodes[b], along);
        for (std::size_t a = 0; a < f.near.dimensions; ++a) whole_rate += rate.foot[a][e] * slide[a];
        const Vec3 by_node = f.spring.pull_rate(f.whole, whole_rate, rate.normal * along);
        for (std::size_t a = 0; a < of_gap; ++a) {
          double share_rate = 0;
          for (std::size_t d = 0; a >= first && d < f.near.dimensions; ++d)
            share_rate -= f.near.slope[d][a - first] * rate.foot[d][e];
          const Vec3 force = share(s, a, f.near) * by_node + share_rate * pull;
          for (int i = 0; i < 3; ++i) blocks[a * n + b](i, e) = force[i];
        }
      }
    }
  }
}

}  // namespace isochor
