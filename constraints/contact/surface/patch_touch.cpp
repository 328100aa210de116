// Where points on a surface touch a patch, and how that changes with what friction holds on to: the
// nearest place and the tangent plane there, and the triangle that the pull kept turns with.
#include <algorithm>
#include <cmath>

#include "constraints/contact/friction/turning_frame.h"
#include "constraints/contact/surface/surface_contact_pool.h"

namespace isochor {

// Turn with the first triangle of the point.
Mat3 PatchGeometry::axes(Index s, std::span<const Vec3> x) const {
  const auto& c = setup_->surface->corners(setup_->surface->triangles_at(s)[0]);
  const Vec3 u = x[at(c[1])] - x[at(c[0])], v = x[at(c[2])] - x[at(c[0])];
  return turning_axes(u, cross(u, v));
}

PatchGeometry::TouchAt PatchGeometry::touch(const StencilRequest&, const SurfaceFrames& frames,
                                            Index s) const {
  TouchAt out;
  out.near = nearest(s, frames.lag);
  out.share = std::isfinite(out.near.distance) ? 1 : 0;
  out.normal = out.near.normal;
  for (std::size_t i = 0; i < gap_nodes(s); ++i) out.weight[i] = share(s, i, out.near);
  return out;
}

class PatchGeometry::Rates {
 public:
  Rates(const PatchGeometry& geometry, const StencilRequest& q, const SurfaceFrames& frames, Index s,
        const TouchAt& touch)
      : touch_(touch),
        nodes_(geometry.nodes_[s]),
        corner_(geometry.setup_->surface->corners(geometry.setup_->surface->triangles_at(s)[0])),
        first_(geometry.setup_->surface->points()[at(s)].nodes),
        end_(geometry.gap_nodes(s)) {
    u_ = frames.lag[at(corner_[1])] - frames.lag[at(corner_[0])];
    v_ = frames.lag[at(corner_[2])] - frames.lag[at(corner_[0])];
    for (std::size_t a = 0; a < touch.near.dimensions && !q.increment.before.empty(); ++a) {
      for (std::size_t k = first_; k < end_; ++k)
        slide_[a] -=
            touch.near.slope[a][k - first_] * (q.x[at(nodes_[k])] - q.increment.before[at(nodes_[k])]);
    }
  }

  void node(std::size_t b) {
    node_ = nodes_[b];
    const std::size_t place = b < first_ ? kPatchNodes : b - first_;
    rate_ = b < end_ ? patch_rate(touch_.near, touch_.weight[b], place) : PatchRate{};
  }
  Vec3 kept(const Vec3& own, int e) const {
    Vec3 rate{}, u_rate{}, v_rate{};
    rate[e] = 1;
    if (node_ == corner_[0]) u_rate = v_rate = -rate;
    if (node_ == corner_[1]) u_rate = rate;
    if (node_ == corner_[2]) v_rate = rate;
    return turning_rate(u_, u_rate, cross(u_, v_), cross(u_rate, v_) + cross(u_, v_rate), own);
  }
  void add(int e, TouchRate<kMost>& out) const {
    for (int i = 0; i < 3; ++i) out.normal[i] = rate_.normal(i, e);
    const PatchPoint& near = touch_.near;
    for (std::size_t d = 0; d < near.dimensions; ++d) {
      out.whole += rate_.foot[d][e] * slide_[d];
      for (std::size_t a = first_; a < end_; ++a)
        out.weight[a] -= near.slope[d][a - first_] * rate_.foot[d][e];
    }
  }

 private:
  const TouchAt& touch_;
  std::span<const Index> nodes_;
  const std::array<Index, 3>& corner_;  // of the triangle that turns what is kept
  std::size_t first_, end_;             // nodes of the patch
  Vec3 u_, v_;                          // from its first corner
  std::array<Vec3, 2> slide_{};         // what the nearest place slides over as its coordinates change
  Index node_ = -1;                     // that moves
  PatchRate rate_;
};

PatchGeometry::Rates PatchGeometry::rates(const StencilRequest& q, const SurfaceFrames& frames, Index s,
                                          const TouchAt& touch) const {
  return {*this, q, frames, s, touch};
}

template class FrictionalPool<PatchGeometry>;

}  // namespace isochor
