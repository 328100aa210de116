// Where points touch a rigid shape, and how that changes with what friction holds on to.
#include <algorithm>
#include <cmath>

#include "constraints/contact/rigid/contact_pool.h"

namespace isochor {

RigidGeometry::TouchAt RigidGeometry::touch(const StencilRequest& q, const Frames& frames, Index s) const {
  TouchAt f;
  f.own = own_place(s, frames.lag, q.lag.x);
  const Vec3 slope = distance_to(shape(), f.own).normal;
  f.slope = transposed_times(frames.lag.inverse, slope);
  // Fields may be flat where they are far from the surface.
  const double steepness = std::sqrt(dot(f.slope, f.slope));
  f.normal = steepness > 0 ? (1 / steepness) * f.slope : Vec3{0, 0, 1};
  // The surface of the shape below the point, and for a point that keeps away the place on its own body.
  f.touch = f.own - point_[at(s)].offset * slope;
  f.weight = weights(s, f.touch);
  if (const auto& rider = point_[at(s)].rider) {
    const ContactFrame body = frame_of(*rider, q.lag.x);
    f.place = body.to_own(frames.lag.to_world(f.touch));
    for (std::size_t a = 0; a < 4; ++a) f.weight[a] = rider->weight(a, f.place);
  }
  if (!shape_points()) f.carried = frames.now.to_world(f.touch) - frames.before.to_world(f.touch);
  return f;
}

// Rates as node b of the stencil moves. From A y = p - c follows A dy = dp - dc - dA y, and for
// n = A^-T grad d that dn = A^-T (H dy - dA^T n). The frame of the shape moves with its control points, by
// dA v = (turn . v) times the rate of the node.
class RigidGeometry::Rates {
 public:
  Rates(const RigidGeometry& geometry, const StencilRequest& q, const Frames& frames, Index s,
        const TouchAt& touch)
      : geometry_(geometry),
        point_(geometry[s]),
        q_(q),
        frames_(frames),
        s_(s),
        touch_(touch),
        rider_(point_.rider ? &*point_.rider : nullptr),
        first_(rider_ ? 4 : 1),
        curvature_(distance_to(geometry.shape(), touch.own).curvature) {
    if (rider_) body_ = frame_of(*rider_, q.lag.x);
  }

  void node(std::size_t b) {
    node_ = b;
    turn_ = of_shape() ? geometry_.shape_points()->slope(b - first_) : Vec3{};
  }
  Vec3 kept(const Vec3& own, int e) const { return dot(turn_, own) * along(e); }

  void add(int e, TouchRate<kMost>& out) const {
    const Vec3 rate = along(e);
    const ContactFrame& lag = frames_.lag;
    const Vec3 center_rate = of_shape() ? 0.25 * rate : Vec3{};
    Vec3 point_rate{};
    if (!of_shape()) point_rate = rider_ ? rider_->weight(node_, point_.own) * rate : rate;
    const Vec3 own_rate = lag.inverse * (point_rate - center_rate - dot(turn_, touch_.own) * rate);
    const Vec3 bend = curvature_ * own_rate;
    const Vec3 slope_rate = transposed_times(lag.inverse, bend - dot(rate, touch_.slope) * turn_);
    const double steepness = std::sqrt(dot(touch_.slope, touch_.slope));
    const Vec3& n = touch_.normal;
    if (steepness > 0) out.normal = (1 / steepness) * (slope_rate - dot(slope_rate, n) * n);
    const Vec3 touch_rate = own_rate - point_.offset * bend;
    for (std::size_t a = 0; geometry_.shape_points() && a < 4; ++a)
      out.weight[first_ + a] = -dot(geometry_.shape_points()->slope(a), touch_rate);
    if (rider_) {
      Vec3 place_rate = lag.A * touch_rate + center_rate + dot(turn_, touch_.touch) * rate;
      if (!of_shape()) place_rate -= (0.25 + dot(rider_->slope(node_), touch_.place)) * rate;
      place_rate = body_.inverse * place_rate;
      for (std::size_t a = 0; a < 4; ++a) out.weight[a] = dot(rider_->slope(a), place_rate);
    }
    if (q_.increment.before.empty()) return;
    const auto nodes = geometry_.nodes_[s_];
    for (std::size_t i = 0; i < nodes.size(); ++i)
      out.whole += out.weight[i] * (q_.x[at(nodes[i])] - q_.increment.before[at(nodes[i])]);
    if (!geometry_.shape_points()) out.whole -= frames_.now.A * touch_rate - frames_.before.A * touch_rate;
  }

 private:
  bool of_shape() const { return node_ >= first_; }
  static Vec3 along(int e) {
    Vec3 rate{};
    rate[e] = 1;
    return rate;
  }

  const RigidGeometry& geometry_;
  const RigidPoint& point_;
  const StencilRequest& q_;
  const Frames& frames_;
  Index s_;
  const TouchAt& touch_;
  const ControlPoints* rider_;    // null: the point is a node
  std::size_t first_, node_ = 0;  // of the control points of the shape; the one that moves
  Mat3 curvature_;
  ContactFrame body_;  // of the rider
  Vec3 turn_{};
};

RigidGeometry::Rates RigidGeometry::rates(const StencilRequest& q, const Frames& frames, Index s,
                                          const TouchAt& touch) const {
  return {*this, q, frames, s, touch};
}

template class FrictionalPool<RigidGeometry>;

}  // namespace isochor
