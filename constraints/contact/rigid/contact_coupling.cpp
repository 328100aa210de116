// How the friction of ContactPool changes with what it holds on to: the normal force, and the frame.
#include <algorithm>
#include <cmath>

#include "constraints/contact/rigid/contact_pool.h"

namespace isochor {

// Rates of pull and weights as `node` of the stencil moves at `rate`, in what the lag decides alone. From
// A y = p - c follows A dy = dp - dc - dA y, and for n = A^-T grad d that dn = A^-T (H dy - dA^T n).
ContactPool::FrictionRate ContactPool::friction_rate(const StencilRequest& q, const Frames& frames, Index s,
                                                     const Friction& f, const Mat3& curvature,
                                                     std::size_t node, const Vec3& rate) const {
  FrictionRate out;
  const auto& rider = rider_[at(s)];
  const std::size_t first = rider ? 4 : 1;
  const ContactFrame& lag = frames.lag;
  // The frame of the shape moves with its control points; dA v = (slope . v) rate.
  const bool of_shape = node >= first;
  const Vec3 turn = of_shape ? points_->slope(node - first) : Vec3{};
  const Vec3 center_rate = of_shape ? 0.25 * rate : Vec3{};
  Vec3 point_rate{};
  if (!of_shape) point_rate = rider ? rider->weight(node, rider_own_[at(s)]) * rate : rate;
  const Vec3 own_rate = lag.inverse * (point_rate - center_rate - dot(turn, f.own) * rate);
  const Vec3 bend = curvature * own_rate;
  const Vec3 slope_rate = transposed_times(lag.inverse, bend - dot(rate, f.slope) * turn);
  const double steepness = std::sqrt(dot(f.slope, f.slope));
  const Vec3& n = f.spring.normal;
  const Vec3 normal_rate = steepness > 0 ? (1 / steepness) * (slope_rate - dot(slope_rate, n) * n) : Vec3{};
  const Vec3 touch_rate = own_rate - offset_[at(s)] * bend;
  for (std::size_t a = 0; points_ && a < 4; ++a) out.weight[first + a] = -dot(points_->slope(a), touch_rate);
  if (rider) {
    const ContactFrame body = frame_of(*rider, q.lag.x);
    Vec3 place_rate = lag.A * touch_rate + center_rate + dot(turn, f.touch) * rate;
    if (!of_shape) place_rate -= (0.25 + dot(rider->slope(node), f.place)) * rate;
    place_rate = body.inverse * place_rate;
    for (std::size_t a = 0; a < 4; ++a) out.weight[a] = dot(rider->slope(a), place_rate);
  }
  Vec3 whole_rate = (dot(turn, f.kept) / stick_[at(s)]) * rate;
  if (!q.increment.before.empty()) {
    const auto nodes = nodes_[s];
    for (std::size_t i = 0; i < nodes.size(); ++i)
      whole_rate += out.weight[i] * (q.x[at(nodes[i])] - q.increment.before[at(nodes[i])]);
    if (!points_) whole_rate -= frames.now.A * touch_rate - frames.before.A * touch_rate;
  }
  out.pull = f.spring.pull_rate(f.whole, whole_rate, normal_rate);
  return out;
}

void ContactPool::lag_derivatives(const StencilRequest& q, const LagSlots& slots) const {
  const Frames now = frames(q);
  for (Index s = q.begin; s < q.end; ++s) {
    const std::size_t n = nodes_[s].size();
    Mat3* blocks = slots.block.data() + slots.block_offset[at(s)];
    Vec3* column = slots.column.data() + nodes_.offset[at(s)];
    const Friction f = friction(q, now, s);
    if (q.lag.x.empty() || !(f.spring.limit > 0)) continue;
    const Vec3 pull = f.spring.pull(), by_multiplier = -f.mu * f.spring.pull_by_limit();
    const Mat3 curvature = distance_to(shape_, f.own).curvature;
    for (std::size_t a = 0; a < n; ++a) column[a] = f.weight[a] * by_multiplier;
    for (std::size_t b = 0; b < n; ++b) {
      for (int e = 0; e < 3; ++e) {
        Vec3 rate{};
        rate[e] = 1;
        const FrictionRate r = friction_rate(q, now, s, f, curvature, b, rate);
        for (std::size_t a = 0; a < n; ++a) {
          const Vec3 force = f.weight[a] * r.pull + r.weight[a] * pull;
          for (int i = 0; i < 3; ++i) blocks[a * n + b](i, e) = force[i];
        }
      }
    }
  }
}

}  // namespace isochor
