#include "constraints/contact/surface/edge_geometry.h"

#include <algorithm>

namespace isochor {

EdgeGeometry::EdgeGeometry(std::shared_ptr<const Setup> setup, std::vector<Index> partner)
    : setup_(std::move(setup)), partner_(std::move(partner)) {
  for (Index s = 0; s < static_cast<Index>(partner_.size()); ++s) {
    if (partner_[at(s)] >= 0)
      nodes_.push(setup_->edges->nodes(s, partner_[at(s)]));
    else
      nodes_.push({});
  }
}

std::array<Vec3, kPairNodes> EdgeGeometry::places(Index s, std::span<const Vec3> x) const {
  std::array<Vec3, kPairNodes> out;
  const auto nodes = nodes_[s];
  for (std::size_t i = 0; i < kPairNodes; ++i) out[i] = x[at(nodes[i])];
  return out;
}

Vec3 EdgeGeometry::push(Index s, double multiplier, std::span<const Vec3> x) const {
  const auto slope = edge_slopes(places(s, x), gap(s, x), setup_->offset);
  Vec3 out{};
  for (std::size_t i = 0; i < kEdgeNodes; ++i) out -= multiplier * slope[i];
  return out;
}

EdgeGeometry::Gap EdgeGeometry::gap_at(const SurfaceFrames& frames, Index s, Want want) const {
  Gap gap;
  gap.x = places(s, frames.now);
  gap.edges = edge_gap(gap.x, setup_->offset);
  gap.value = gap.edges.value;
  if (want != Want::value) gap.slopes = edge_slopes(gap.x, gap.edges, setup_->offset);
  return gap;
}

void EdgeGeometry::add_curvature(const StencilRequest& q, const SurfaceFrames&, const Gap& gap, Index s,
                                 Mat3* blocks) const {
  const double multiplier = q.function_multiplier[at(s)];
  // Definite without the curvature of the gap.
  if (multiplier != 0 && q.definiteness == Definiteness::exact)
    add_edge_curvature(gap.x, gap.edges, setup_->offset, multiplier, blocks);
}

}  // namespace isochor
