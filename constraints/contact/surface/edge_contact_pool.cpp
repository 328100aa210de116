#include "constraints/contact/surface/edge_contact_pool.h"

#include <algorithm>
#include <cmath>

namespace isochor {

void EdgeContactPool::accept(const StencilRequest& q, std::span<double> memory) const {
  keep_pairs(geometry().partner(), friction_memory().per_point(), memory);
  FrictionalPool::accept(q, memory);
}

Renewal EdgeContactPool::renewed(const RenewalRequest& q) const {
  const SurfaceEdges& edges = *setup().edges;
  const double small = 1e-3 * edges.size();
  const std::vector<Index>& partner = geometry().partner();
  std::vector<SurfaceEdges::Finding> found(partner.size());
  const std::vector<Index> base =
      q.memory.empty() ? partner : pairs_in_memory(q.memory, friction_memory().per_point());
  edges.search(q.from, q.x, reach(), setup().offset, base, q.parallel, found);
  Renewal answer;
  bool needed = false;
  std::vector<Index> target = base;
  for (Index s = 0; s < stencils(); ++s) {
    const SurfaceEdges::Finding& f = found[at(s)];
    const Index c = base[at(s)];
    if (f.crossed >= 0) {
      // Far behind what it went through: known, or unseen.
      if (c == f.crossed || base[at(f.crossed)] == s) {
        const bool held = edges.gap(s, f.crossed, q.x, setup().offset).value < 0;
        if (!held) ++(q.solved ? answer.passing : answer.crossed);
      } else {
        target[at(s)] = f.crossed;
        ++answer.crossed;
        needed = true;
      }
      continue;
    }
    const double present = c >= 0 ? edges.gap(s, c, q.x, setup().offset).value : setup().open;
    if (f.deepest == c) continue;
    const bool mutual = f.deepest >= 0 && base[at(f.deepest)] == s;
    // What is in contact stays together while the other one's stencil sees to what comes in addition; and
    // no stencil joins in where that one is pressed in already, since it would bring energy with it.
    if (f.deepest < 0 ? present < 0 : mutual && (present < 0 || f.before < -small)) continue;
    target[at(s)] = f.deepest;
    if (f.deepest < 0) continue;
    if (!q.solved)
      needed = needed || f.gap.distance - setup().offset < 0.2 * reach();
    else
      needed = needed || (f.gap.value < 0 && std::abs(f.gap.value - present) > small);
  }
  if (!needed) target = base;
  if (target != partner)
    answer.pool = std::make_shared<EdgeContactPool>(geometry().setup(), std::move(target));
  return answer;
}

Result<std::shared_ptr<const StencilPool>> EdgeContactPool::restored(std::span<const double> memory) const {
  auto kept = checked_pairs(memory, friction_memory().per_point(), stencils(), setup().name, "edge");
  if (!kept) return kept.failure();
  return std::shared_ptr<const StencilPool>(
      std::make_shared<EdgeContactPool>(geometry().setup(), std::move(kept).value()));
}

}  // namespace isochor
