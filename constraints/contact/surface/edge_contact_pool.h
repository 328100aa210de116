// Stencils of edges on moving surfaces against edges that they cross.
#pragma once

#include "constraints/contact/friction/frictional_pool.h"
#include "constraints/contact/surface/pairing.h"
#include "constraints/contact/surface/surface_edges.h"

namespace isochor {

// An edge that bulges outward against the edge of the other side that it meets, its partner; the gap is the
// value of EdgeGap, and the nodes are those. Edges without a partner have none, and a gap that is never
// closed. Both edges of a pair have a stencil, so that neither is master or slave. What friction keeps turns
// with the edge.
class EdgeContactPool final : public FrictionalPool<EdgeContactPool>, public RenewedStencils {
 public:
  struct Setup : PairSetup {
    std::shared_ptr<const SurfaceEdges> edges;
  };
  EdgeContactPool(std::shared_ptr<const Setup> setup, std::vector<Index> partner);

  // By edge: one more than the partner, then what friction keeps.
  void accept(const StencilRequest& request, std::span<double> memory) const override;
  StencilFacets facets() const override { return with_pairs(friction_facets(), *this, *this); }
  Renewal renewed(const RenewalRequest& request) const override;
  Result<std::shared_ptr<const StencilPool>> restored(std::span<const double> memory) const override;

  const Setup& setup() const { return *setup_; }
  bool meets(Index s) const { return partner_[at(s)] >= 0; }
  // Of edges that have a partner.
  EdgeGap gap(Index s, std::span<const Vec3> x) const { return edge_gap(places(s, x), setup_->offset); }
  // What the first edge feels of a multiplier [N].
  Vec3 push(Index s, double multiplier, std::span<const Vec3> x) const;
  // The pull of friction that a step left, at positions x [N].
  Vec3 kept_pull(Index s, std::span<const double> memory, std::span<const Vec3> x) const {
    return pull_in_space(Frames{x, x}, s, memory);
  }

 private:
  friend class FrictionalPool<EdgeContactPool>;
  struct Frames {
    std::span<const Vec3> now, lag;
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

  std::array<Vec3, kPairNodes> places(Index s, std::span<const Vec3> x) const;
  Mat3 axes(Index s, std::span<const Vec3> x) const;
  double reach() const { return setup_->offset + 0.75 * setup_->edges->size(); }

  std::shared_ptr<const Setup> setup_;
  std::vector<Index> partner_;
};

extern template class FrictionalPool<EdgeContactPool>;  // edge_touch.cpp

}  // namespace isochor
