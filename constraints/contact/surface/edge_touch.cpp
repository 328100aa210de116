// Where crossed edges touch, and how that changes with what friction holds on to: the nearest
// places and their weight, the common normal, and the edge that the pull kept turns with.
#include <algorithm>

#include "constraints/contact/friction/turning_frame.h"
#include "constraints/contact/surface/edge_contact_pool.h"

namespace isochor {

// Turn with the edge and the triangles at it.
Mat3 EdgeGeometry::axes(Index s, std::span<const Vec3> x) const {
  const auto& n = (*setup_->edges)[s].node;
  const Vec3 p = x[at(n[1])] - x[at(n[0])];
  const Vec3 out = cross(p, x[at(n[2])] - x[at(n[0])]) - cross(p, x[at(n[3])] - x[at(n[0])]);
  return turning_axes(p, out);
}

EdgeGeometry::TouchAt EdgeGeometry::touch(const StencilRequest&, const SurfaceFrames& frames, Index s) const {
  TouchAt out;
  out.edges = gap(s, frames.lag);
  out.share = out.edges.weight;
  // Edges that do not meet have no normal force, wherever their places are.
  if (out.share == 0) return out;
  out.normal = out.edges.normal;
  for (std::size_t i = 0; i < kPairNodes; ++i) out.weight[i] = out.edges.share(i);
  return out;
}

class EdgeGeometry::Rates {
 public:
  Rates(const EdgeGeometry& geometry, const StencilRequest& q, const SurfaceFrames& frames, Index s,
        const TouchAt& touch)
      : rates_(edge_rates(geometry.places(s, frames.lag), touch.edges)) {
    const auto nodes = geometry.nodes_[s];
    for (std::size_t k = 1; k < kEdgeNodes; ++k)
      way_[k] = frames.lag[at(nodes[k])] - frames.lag[at(nodes[0])];
    for (std::size_t a = 0; a < kPairNodes && !q.increment.before.empty(); ++a)
      slide_[a / kEdgeNodes] +=
          EdgeGap::share_slope(a) * (q.x[at(nodes[a])] - q.increment.before[at(nodes[a])]);
  }

  void node(std::size_t b) { node_ = b; }
  Vec3 kept(const Vec3& own, int e) const {
    if (node_ >= kEdgeNodes) return {};
    Vec3 rate{};
    rate[e] = 1;
    std::array<Vec3, kEdgeNodes> way_rate{};
    for (std::size_t k = 1; k < kEdgeNodes; ++k) {
      if (node_ == 0 || node_ == k) way_rate[k] = node_ == 0 ? -rate : rate;
    }
    const Vec3 beside = way_[2] - way_[3];
    return turning_rate(way_[1], way_rate[1], cross(way_[1], beside),
                        cross(way_rate[1], beside) + cross(way_[1], way_rate[2] - way_rate[3]), own);
  }
  void add(int e, TouchRate<kPairNodes>& out) const {
    for (int i = 0; i < 3; ++i) out.normal[i] = rates_.normal[node_](i, e);
    out.share = rates_.weight[node_][e];
    for (std::size_t t = 0; t < 2; ++t) out.whole += rates_.place[t][node_][e] * slide_[t];
    for (std::size_t a = 0; a < kPairNodes; ++a)
      out.weight[a] = EdgeGap::share_slope(a) * rates_.place[a / kEdgeNodes][node_][e];
  }

 private:
  EdgeRates rates_;
  std::array<Vec3, kEdgeNodes> way_{};  // from the start of the edge
  std::array<Vec3, 2> slide_{};         // what the nearest places slide over as they move along their edges
  std::size_t node_ = 0;                // that moves
};

EdgeGeometry::Rates EdgeGeometry::rates(const StencilRequest& q, const SurfaceFrames& frames, Index s,
                                        const TouchAt& touch) const {
  return {*this, q, frames, s, touch};
}

template class FrictionalPool<EdgeGeometry>;

}  // namespace isochor
