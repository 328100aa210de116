// Edges on moving surfaces against edges that they cross: the gap and its derivatives.
#pragma once

#include "constraints/contact/friction/friction_point.h"
#include "constraints/contact/surface/patch_geometry.h"
#include "constraints/contact/surface/surface_edges.h"

namespace isochor {

// An edge that bulges outward against the edge of the other side that it meets, its partner; the gap is the
// value of EdgeGap, and the nodes are those. Edges without a partner have none, and a gap that is never
// closed. Both edges of a pair have a stencil, so that neither is master or slave. What friction keeps turns
// with the edge.
class EdgeGeometry {
 public:
  struct Setup : PairSetup {
    std::shared_ptr<const SurfaceEdges> edges;
  };
  struct Gap {
    double value = 0;
    std::array<Vec3, kPairNodes> x{}, slopes{};
    EdgeGap edges;
    Vec3 slope(std::size_t i, double factor) const { return factor * slopes[i]; }
  };
  struct TouchAt : Touch<kPairNodes> {
    EdgeGap edges;
  };
  class Rates;  // edge_touch.cpp

  EdgeGeometry(std::shared_ptr<const Setup> setup, std::vector<Index> partner);

  const std::shared_ptr<const Setup>& setup() const { return setup_; }
  const Lists& nodes() const { return nodes_; }
  const std::vector<Index>& partner() const { return partner_; }
  // Of edges that have a partner.
  EdgeGap gap(Index s, std::span<const Vec3> x) const { return edge_gap(places(s, x), setup_->offset); }
  // What the first edge feels of a multiplier [N].
  Vec3 push(Index s, double multiplier, std::span<const Vec3> x) const;

  // What FrictionalPool asks.
  bool meets(Index s) const { return partner_[at(s)] >= 0; }
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
  std::array<Vec3, kPairNodes> places(Index s, std::span<const Vec3> x) const;
  Mat3 axes(Index s, std::span<const Vec3> x) const;

  std::shared_ptr<const Setup> setup_;
  std::vector<Index> partner_;
  Lists nodes_;
};

}  // namespace isochor
