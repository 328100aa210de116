// Stencils of points on moving surfaces against the triangles that are close to them.
#pragma once

#include "constraints/contact/friction/frictional_pool.h"
#include "constraints/contact/surface/contact_surface.h"
#include "constraints/contact/surface/pairing.h"

namespace isochor {

// A point of the surface against a patch of the other one; the gap is its signed distance less an offset. The
// nodes are those of the point, then those of the patch: a triangle and its neighbors across edges, among
// which the nearest place is found at every evaluation. Points that nothing is close to have no nodes, and a
// gap that is never closed. What friction keeps turns with the triangle of the point, whose corners are nodes
// of the stencil as well where friction is coupled.
class SurfaceContactPool final : public FrictionalPool<SurfaceContactPool>, public RenewedStencils {
 public:
  struct Setup : PairSetup {
    std::shared_ptr<const ContactSurface> surface;
  };
  // `center`: by point the triangle its patch is around, or -1.
  SurfaceContactPool(std::shared_ptr<const Setup> setup, std::vector<Index> center);

  // By point: one more than the center, then what friction keeps.
  void accept(const StencilRequest& request, std::span<double> memory) const override;
  StencilFacets facets() const override { return with_pairs(friction_facets(), *this, *this); }
  Renewal renewed(const RenewalRequest& request) const override;
  Result<std::shared_ptr<const StencilPool>> restored(std::span<const double> memory) const override;

  const Setup& setup() const { return *setup_; }
  bool meets(Index s) const { return center_[at(s)] >= 0; }
  // The nearest place and its distance, without the offset; of points that something is close to.
  PatchPoint nearest(Index s, std::span<const Vec3> x) const;
  // Share of node i of a stencil in the motion of the point relative to the patch.
  double share(Index s, std::size_t i, const PatchPoint& near) const;
  // The pull of friction that a step left, at positions x [N].
  Vec3 kept_pull(Index s, std::span<const double> memory, std::span<const Vec3> x) const {
    return pull_in_space(Frames{x, x}, s, memory);
  }

 private:
  friend class FrictionalPool<SurfaceContactPool>;
  static constexpr std::size_t kMost = kFaceNodes + kPatchNodes + 3;  // nodes of a stencil
  struct Frames {
    std::span<const Vec3> now, lag;
  };
  struct Gap {
    double value = 0;
    bool exists = false;
    PatchPoint near;
    std::array<double, kMost> weight{};
    Vec3 slope(std::size_t i, double factor) const { return factor * weight[i] * near.normal; }
  };
  struct TouchAt : Touch<kMost> {
    PatchPoint near;
  };
  class Rates;  // surface_touch.cpp

  // What FrictionalPool asks.
  static Frames frames(const StencilRequest& q) { return {q.x, q.lag.x.empty() ? q.x : q.lag.x}; }
  double open() const { return setup_->open; }
  double stick(Index s) const { return setup_->stick[at(s)]; }
  Gap gap_at(const Frames& frames, Index s, Want want) const;
  void add_curvature(const StencilRequest& request, const Frames& frames, const Gap& gap, Index s,
                     Mat3* blocks) const;
  TouchAt touch(const StencilRequest& request, const Frames& frames, Index s) const;
  Vec3 to_space(const Frames& frames, Index s, const Vec3& own) const { return axes(s, frames.lag) * own; }
  Vec3 to_own(const Frames& frames, Index s, const Vec3& v) const {
    return transposed_times(axes(s, frames.now), v);
  }
  Rates rates(const StencilRequest& request, const Frames& frames, Index s, const TouchAt& touch) const;

  // Nodes of a stencil that its gap depends on; those behind them only turn the pull that is kept.
  std::size_t gap_nodes(Index s) const {
    return setup_->surface->points()[at(s)].nodes + patch_[at(s)].nodes;
  }
  Mat3 axes(Index s, std::span<const Vec3> x) const;
  // The nearest place of a patch around a triangle.
  PatchPoint seen_from(Index s, Index center, std::span<const Vec3> x) const;
  bool reaches_out(const PatchPoint& near, Index s, Index center, std::span<const Vec3> x) const;
  double reach() const { return setup_->offset + 0.75 * setup_->surface->size(); }

  std::shared_ptr<const Setup> setup_;
  std::vector<Index> center_;
  std::vector<Patch> patch_;
};

extern template class FrictionalPool<SurfaceContactPool>;  // surface_touch.cpp

}  // namespace isochor
