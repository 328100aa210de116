#include "constraints/contact/surface/edge_contact_pool.h"

#include <algorithm>
#include <cmath>

namespace isochor {

EdgeContactPool::EdgeContactPool(std::shared_ptr<const Setup> setup, std::vector<Index> partner)
    : FrictionalPool(setup->name, {setup->friction, 1}, setup->coupled),
      setup_(std::move(setup)),
      partner_(std::move(partner)) {
  for (Index s = 0; s < static_cast<Index>(partner_.size()); ++s) {
    if (partner_[at(s)] >= 0)
      nodes_.push(setup_->edges->nodes(s, partner_[at(s)]));
    else
      nodes_.push({});
  }
  finish_topology();
}

std::array<Vec3, kPairNodes> EdgeContactPool::places(Index s, std::span<const Vec3> x) const {
  std::array<Vec3, kPairNodes> out;
  const auto nodes = nodes_[s];
  for (std::size_t i = 0; i < kPairNodes; ++i) out[i] = x[at(nodes[i])];
  return out;
}

Vec3 EdgeContactPool::push(Index s, double multiplier, std::span<const Vec3> x) const {
  const auto slope = edge_slopes(places(s, x), gap(s, x), setup_->offset);
  Vec3 out{};
  for (std::size_t i = 0; i < kEdgeNodes; ++i) out -= multiplier * slope[i];
  return out;
}

EdgeContactPool::Gap EdgeContactPool::gap_at(const Frames& frames, Index s, Want want) const {
  Gap gap;
  gap.x = places(s, frames.now);
  gap.edges = edge_gap(gap.x, setup_->offset);
  gap.value = gap.edges.value;
  if (want != Want::value) gap.slopes = edge_slopes(gap.x, gap.edges, setup_->offset);
  return gap;
}

void EdgeContactPool::add_curvature(const StencilRequest& q, const Frames&, const Gap& gap, Index s,
                                    Mat3* blocks) const {
  const double multiplier = q.function_multiplier[at(s)];
  // Definite without the curvature of the gap.
  if (multiplier != 0 && q.definiteness == Definiteness::exact)
    add_edge_curvature(gap.x, gap.edges, setup_->offset, multiplier, blocks);
}

void EdgeContactPool::accept(const StencilRequest& q, std::span<double> memory) const {
  keep_pairs(partner_, friction_memory().per_point(), memory);
  FrictionalPool::accept(q, memory);
}

Renewal EdgeContactPool::renewed(const RenewalRequest& q) const {
  const SurfaceEdges& edges = *setup_->edges;
  const double small = 1e-3 * edges.size();
  std::vector<SurfaceEdges::Finding> found(partner_.size());
  const std::vector<Index> base =
      q.memory.empty() ? partner_ : pairs_in_memory(q.memory, friction_memory().per_point());
  edges.search(q.from, q.x, reach(), setup_->offset, base, q.parallel, found);
  Renewal answer;
  bool needed = false;
  std::vector<Index> target = base;
  for (Index s = 0; s < stencils(); ++s) {
    const SurfaceEdges::Finding& f = found[at(s)];
    const Index c = base[at(s)];
    if (f.crossed >= 0) {
      // Far behind what it went through: known, or unseen.
      if (c == f.crossed || base[at(f.crossed)] == s) {
        const bool held = edges.gap(s, f.crossed, q.x, setup_->offset).value < 0;
        if (!held) ++(q.solved ? answer.passing : answer.crossed);
      } else {
        target[at(s)] = f.crossed;
        ++answer.crossed;
        needed = true;
      }
      continue;
    }
    const double present = c >= 0 ? edges.gap(s, c, q.x, setup_->offset).value : setup_->open;
    if (f.deepest == c) continue;
    const bool mutual = f.deepest >= 0 && base[at(f.deepest)] == s;
    // What is in contact stays together while the other one's stencil sees to what comes in addition; and
    // no stencil joins in where that one is pressed in already, since it would bring energy with it.
    if (f.deepest < 0 ? present < 0 : mutual && (present < 0 || f.before < -small)) continue;
    target[at(s)] = f.deepest;
    if (f.deepest < 0) continue;
    if (!q.solved)
      needed = needed || f.gap.distance - setup_->offset < 0.2 * reach();
    else
      needed = needed || (f.gap.value < 0 && std::abs(f.gap.value - present) > small);
  }
  if (!needed) target = base;
  if (target != partner_) answer.pool = std::make_shared<EdgeContactPool>(setup_, std::move(target));
  return answer;
}

Result<std::shared_ptr<const StencilPool>> EdgeContactPool::restored(std::span<const double> memory) const {
  auto kept = checked_pairs(memory, friction_memory().per_point(), stencils(), setup_->name, "edge");
  if (!kept) return Error{kept.error()};
  return std::shared_ptr<const StencilPool>(
      std::make_shared<EdgeContactPool>(setup_, std::move(kept).value()));
}

}  // namespace isochor
