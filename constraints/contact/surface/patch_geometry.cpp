#include "constraints/contact/surface/patch_geometry.h"

#include <algorithm>
#include <cmath>

namespace isochor {

PatchGeometry::PatchGeometry(std::shared_ptr<const Setup> setup, std::vector<Index> center)
    : setup_(std::move(setup)), center_(std::move(center)) {
  const ContactSurface& surface = *setup_->surface;
  const bool turns = setup_->coupled && setup_->friction.any();
  patch_.resize(center_.size());
  for (Index s = 0; s < static_cast<Index>(center_.size()); ++s) {
    std::array<Index, kMost> nodes{};
    std::size_t count = 0;
    if (center_[at(s)] >= 0) {
      const SurfacePoint& point = surface.points()[at(s)];
      for (std::size_t k = 0; k < point.nodes; ++k) nodes[count++] = point.node[k];
      const ContactSurface::Around around = surface.around(center_[at(s)], s);
      for (std::size_t k = 0; k < around.patch.nodes; ++k) nodes[count++] = around.node[k];
      patch_[at(s)] = around.patch;
      for (const Index corner : surface.corners(surface.triangles_at(s)[0])) {
        const auto end = nodes.begin() + static_cast<std::ptrdiff_t>(count);
        if (turns && std::find(nodes.begin(), end, corner) == end) nodes[count++] = corner;
      }
    }
    nodes_.push(std::span(nodes).first(count));
  }
}

PatchPoint PatchGeometry::nearest(Index s, std::span<const Vec3> x) const {
  const SurfacePoint& point = setup_->surface->points()[at(s)];
  const auto nodes = nodes_[s].subspan(point.nodes, patch_[at(s)].nodes);
  std::array<Vec3, kPatchNodes> corner{};
  for (std::size_t k = 0; k < nodes.size(); ++k) corner[k] = x[at(nodes[k])];
  return nearest_on_patch(point.position(x), std::span(corner).first(nodes.size()), patch_[at(s)]);
}

double PatchGeometry::share(Index s, std::size_t i, const PatchPoint& near) const {
  const SurfacePoint& point = setup_->surface->points()[at(s)];
  if (i >= gap_nodes(s)) return 0;
  return i < point.nodes ? point.weight[i] : -near.weight[i - point.nodes];
}

PatchGeometry::Gap PatchGeometry::gap_at(const SurfaceFrames& frames, Index s, Want want) const {
  Gap gap;
  gap.near = nearest(s, frames.now);
  gap.exists = std::isfinite(gap.near.distance);
  gap.value = gap.exists ? gap.near.distance - setup_->offset : setup_->open;
  if (want == Want::value) return gap;
  for (std::size_t i = 0; i < gap_nodes(s); ++i) gap.weight[i] = share(s, i, gap.near);
  return gap;
}

void PatchGeometry::add_curvature(const StencilRequest& q, const SurfaceFrames&, const Gap& gap, Index s,
                                  Mat3* blocks) const {
  const double multiplier = q.function_multiplier[at(s)];
  if (multiplier == 0 || !gap.exists) return;
  add_patch_curvature(gap.near, multiplier, q.definiteness != Definiteness::exact,
                      std::span(gap.weight).first(gap_nodes(s)), setup_->surface->points()[at(s)].nodes,
                      blocks);
}

}  // namespace isochor
