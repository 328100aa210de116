// Points on a moving surface against patches of another: the gap and its derivatives.
#pragma once

#include "constraints/contact/friction/friction_point.h"
#include "constraints/contact/surface/contact_surface.h"
#include "constraints/contact/surface/pairing.h"

namespace isochor {

// Positions now, and those of the lag.
struct SurfaceFrames {
  std::span<const Vec3> now, lag;
};
inline SurfaceFrames surface_frames(const StencilRequest& q) {
  return {q.x, q.lag.x.empty() ? q.x : q.lag.x};
}

// The gap of a point is its signed distance to a patch less an offset. The nodes are those of the point, then
// those of the patch: a triangle and its neighbors across edges, among which the nearest place is found at
// every evaluation. Points that nothing is close to have no nodes, and a gap that is never closed. What
// friction keeps turns with the triangle of the point, whose corners are nodes as well where it is coupled.
class PatchGeometry {
 public:
  static constexpr std::size_t kMost = kFaceNodes + kPatchNodes + 3;  // nodes of a stencil
  struct Setup : PairSetup {
    std::shared_ptr<const ContactSurface> surface;
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
  class Rates;  // patch_touch.cpp

  // `center`: by point the triangle its patch is around, or -1.
  PatchGeometry(std::shared_ptr<const Setup> setup, std::vector<Index> center);

  const std::shared_ptr<const Setup>& setup() const { return setup_; }
  const Lists& nodes() const { return nodes_; }
  const std::vector<Index>& center() const { return center_; }
  // The nearest place and its distance, without the offset; of points that something is close to.
  PatchPoint nearest(Index s, std::span<const Vec3> x) const;
  // Share of node i of a stencil in the motion of the point relative to the patch.
  double share(Index s, std::size_t i, const PatchPoint& near) const;

  // What FrictionalPool asks.
  bool meets(Index s) const { return center_[at(s)] >= 0; }
  double open() const { return setup_->open; }
  double stick(Index s) const { return setup_->stick[at(s)]; }
  static SurfaceFrames frames(const StencilRequest& q) { return surface_frames(q); }
  Gap gap_at(const SurfaceFrames& frames, Index s, Want want) const;
  void add_curvature(const StencilRequest& request, const SurfaceFrames& frames, const Gap& gap, Index s,
                     Mat3* blocks) const;
  TouchAt touch(const StencilRequest& request, const SurfaceFrames& frames, Index s) const;
  Vec3 to_space(const SurfaceFrames& frames, Index s, const Vec3& own) const {
    return axes(s, frames.lag) * own;
  }
  Vec3 to_own(const SurfaceFrames& frames, Index s, const Vec3& v) const {
    return transposed_times(axes(s, frames.now), v);
  }
  Rates rates(const StencilRequest& request, const SurfaceFrames& frames, Index s,
              const TouchAt& touch) const;

 private:
  // Nodes of a stencil that its gap depends on; those behind them only turn the pull that is kept.
  std::size_t gap_nodes(Index s) const {
    return setup_->surface->points()[at(s)].nodes + patch_[at(s)].nodes;
  }
  Mat3 axes(Index s, std::span<const Vec3> x) const;

  std::shared_ptr<const Setup> setup_;
  std::vector<Index> center_;
  std::vector<Patch> patch_;
  Lists nodes_;
};

}  // namespace isochor
