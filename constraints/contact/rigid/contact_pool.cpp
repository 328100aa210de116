#include "constraints/contact/rigid/contact_pool.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace isochor {

namespace {

double norm(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

Vec3 tangential(const Vec3& v, const Vec3& normal) {
  return v - dot(v, normal) * normal;
}

void add_outer(Mat3& m, double s, const Vec3& a, const Vec3& b) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m(i, j) += s * a[i] * b[j];
  }
}

// B^T m B.
Mat3 pulled_back(const Mat3& B, const Mat3& m) {
  Mat3 half, out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) half(i, j) = m(i, 0) * B(0, j) + m(i, 1) * B(1, j) + m(i, 2) * B(2, j);
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      out(i, j) = B(0, i) * half(0, j) + B(1, i) * half(1, j) + B(2, i) * half(2, j);
  }
  return out;
}

// Negative eigenvalues raised to zero or turned positive.
Mat3 made_definite(const Mat3& m, Definiteness policy) {
  Eigen::Matrix3d full;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) full(i, j) = 0.5 * (m(i, j) + m(j, i));
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(full);
  Mat3 out;
  for (int k = 0; k < 3; ++k) {
    const double value = solver.eigenvalues()[k];
    const Vec3 v{solver.eigenvectors()(0, k), solver.eigenvectors()(1, k), solver.eigenvectors()(2, k)};
    add_outer(out, policy == Definiteness::absolute ? std::abs(value) : std::max(value, 0.0), v, v);
  }
  return out;
}

}  // namespace

void ContactPool::add(Index node, double stick, double size, const Vec3& inset) {
  std::vector<Index> nodes = {node};
  if (points_) nodes.insert(nodes.end(), points_->node.begin(), points_->node.end());
  nodes_.push(nodes);
  stick_.push_back(stick);
  offset_.push_back(0);
  size_.push_back(size);
  inset_.push_back(inset);
  rider_.emplace_back();
  rider_own_.push_back({});
}

void ContactPool::add(const ControlPoints& body, const Vec3& own, double offset, double stick) {
  std::vector<Index> nodes(body.node.begin(), body.node.end());
  if (points_) nodes.insert(nodes.end(), points_->node.begin(), points_->node.end());
  nodes_.push(nodes);
  stick_.push_back(stick);
  offset_.push_back(offset);
  size_.push_back(0);
  inset_.push_back({});
  rider_.emplace_back(body);
  rider_own_.push_back(own);
}

Vec3 ContactPool::point(Index s, std::span<const Vec3> x) const {
  const auto nodes = nodes_[s];
  const auto& rider = rider_[at(s)];
  if (!rider) return x[at(nodes[0])];
  Vec3 p{};
  for (std::size_t a = 0; a < 4; ++a) p += rider->weight(a, rider_own_[at(s)]) * x[at(nodes[a])];
  return p;
}

double ContactPool::gap(Index s, const ContactFrame& frame, std::span<const Vec3> x) const {
  return distance_value(shape_, own_place(s, frame, x)) - offset_[at(s)];
}

// Weights of the nodes in the motion of the point relative to the shape, the point being at `own` in the
// shape's axes.
std::array<double, ContactPool::kMost> ContactPool::weights(Index s, const Vec3& own) const {
  std::array<double, kMost> w{};
  const auto& rider = rider_[at(s)];
  const std::size_t count = rider ? 4 : 1;
  w[0] = 1;
  for (std::size_t a = 0; rider && a < 4; ++a) w[a] = rider->weight(a, rider_own_[at(s)]);
  for (std::size_t a = 0; points_ && a < 4; ++a) w[count + a] = -points_->weight(a, own);
  return w;
}

ContactPool::Frames ContactPool::frames(const StencilRequest& q) const {
  Frames f;
  f.now = frame(q.increment.t1, q.x);
  f.lag = q.lag.x.empty() ? f.now : frame(q.increment.t1, q.lag.x);
  f.before = q.increment.before.empty() ? f.now : frame(q.increment.t0, q.increment.before);
  return f;
}

Vec3 ContactPool::kept_pull(Index s, std::span<const double> memory) const {
  if (memory.empty()) return {};
  const double* m = memory.data() + static_cast<std::size_t>(memory_per_point()) * at(s);
  return {m[0], m[1], m[2]};
}

double ContactPool::coefficient(Index s, std::span<const double> memory) const {
  const auto place = static_cast<std::size_t>(memory_per_point()) * at(s) + 3;
  return friction_.coefficient(place < memory.size() ? memory.data() + place : nullptr);
}

// Limit, tangent plane and stretch of the spring that stands for sticking friction. Without an increment
// there is no slip, and what is left is the pull that the last step ended with.
ContactPool::Friction ContactPool::friction(const StencilRequest& q, const Frames& frames, Index s) const {
  Friction f;
  f.spring.stiffness = stick_[at(s)];
  f.kept = kept_pull(s, q.memory);
  const Vec3 kept = frames.lag.A * f.kept;
  if (q.lag.x.empty()) {
    f.spring.limit = norm(kept);
    f.spring.z = (1 / stick_[at(s)]) * kept;
    return f;
  }
  const auto nodes = nodes_[s];
  f.mu = coefficient(s, q.memory);
  f.spring.limit = f.mu * std::max(0.0, -q.lag.function_multiplier[at(s)]);
  f.own = own_place(s, frames.lag, q.lag.x);
  const Vec3 slope = distance_to(shape_, f.own).normal;
  Vec3& normal = f.spring.normal;
  f.slope = transposed_times(frames.lag.inverse, slope);
  // Fields may be flat where they are far from the surface.
  const double steepness = norm(f.slope);
  normal = steepness > 0 ? (1 / steepness) * f.slope : Vec3{0, 0, 1};
  // Where they touch: the surface of the shape below the point, and for a point that keeps away the place on
  // its own body.
  const Vec3& touch = f.touch = f.own - offset_[at(s)] * slope;
  f.weight = weights(s, touch);
  if (const auto& rider = rider_[at(s)]) {
    const ContactFrame body = frame_of(*rider, q.lag.x);
    f.place = body.to_own(frames.lag.to_world(touch));
    for (std::size_t a = 0; a < 4; ++a) f.weight[a] = rider->weight(a, f.place);
  }
  Vec3 slip{};
  if (!q.increment.before.empty()) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      slip += f.weight[i] * (q.x[at(nodes[i])] - q.increment.before[at(nodes[i])]);
    }
    if (!points_) slip -= frames.now.to_world(touch) - frames.before.to_world(touch);
  }
  f.whole = slip + (1 / stick_[at(s)]) * kept;
  f.spring.z = tangential(f.whole, normal);
  return f;
}

// multiplier times the second derivative of the gap. From A dy = dp - sum w_a dx_a, w_a affine in y, comes
// A d2y = -2 dA dy, so beside the curvature of the shape there are cross terms with its control points.
void ContactPool::add_curvature(const StencilRequest& q, const Distance& d, const ContactFrame& frame,
                                const Vec3& own, Index s, Mat3* blocks) const {
  const double multiplier = q.function_multiplier[at(s)];
  double factor = multiplier;
  if (q.definiteness == Definiteness::projected) factor = std::max(multiplier, 0.0);
  if (q.definiteness == Definiteness::absolute) factor = std::abs(multiplier);
  Mat3 curvature = pulled_back(frame.inverse, d.curvature);
  if (!is_convex(shape_) && q.definiteness != Definiteness::exact) {
    // Its eigenvalues have either sign, whatever that of the multiplier.
    for (double& v : curvature.m) v *= multiplier;
    curvature = made_definite(curvature, q.definiteness);
    factor = 1;
  }
  const auto c = weights(s, own);
  const std::size_t n = nodes_[s].size(), first = rider_[at(s)] ? 4 : 1;
  // The cross terms are indefinite: left out where a definite matrix is asked for.
  const bool cross_terms = points_ && q.definiteness == Definiteness::exact;
  const Vec3 normal = transposed_times(frame.inverse, d.normal);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      Mat3& block = blocks[i * (i + 1) / 2 + j];
      for (std::size_t k = 0; k < 9; ++k) block.m[k] += factor * c[i] * c[j] * curvature.m[k];
      if (!cross_terms) continue;
      if (i >= first) {
        const Vec3 e = transposed_times(frame.inverse, points_->slope(i - first));
        add_outer(block, -multiplier * c[j], normal, e);
      }
      if (j >= first) {
        const Vec3 e = transposed_times(frame.inverse, points_->slope(j - first));
        add_outer(block, -multiplier * c[i], e, normal);
      }
    }
  }
}

void ContactPool::evaluate(const StencilRequest& q, const StencilSlots& slots) const {
  const Frames now = frames(q);
  // Results are read without slip: nothing moves against the friction that is left.
  const bool slips = friction_.any() && !q.lag.x.empty();
  for (Index s = q.begin; s < q.end; ++s) {
    const std::size_t n = nodes_[s].size(), first = at(nodes_.offset[at(s)]);
    const Vec3 own = own_place(s, now.now, q.x);
    const Distance d = distance_to(shape_, own);
    slots.value[at(s)] = d.value - offset_[at(s)];
    slots.energy[at(s)] = 0;
    Friction f;
    if (friction_.any()) {
      f = friction(q, now, s);
      slots.energy[at(s)] = f.spring.energy();
    }
    if (q.want == Want::value) continue;
    const Vec3 normal = transposed_times(now.now.inverse, d.normal);
    const double multiplier = q.function_multiplier[at(s)];
    const auto c = weights(s, own);
    const Vec3 force = slips ? f.spring.pull() : Vec3{};
    for (std::size_t i = 0; i < n; ++i) {
      slots.jacobian[first + i] = c[i] * normal;
      slots.gradient[first + i] = multiplier * c[i] * normal + f.weight[i] * force;
    }
    if (q.want != Want::hessian) continue;
    Mat3* blocks = slots.hessian.data() + hessian_offset()[at(s)];
    std::fill_n(blocks, n * (n + 1) / 2, Mat3{});
    add_curvature(q, d, now.now, own, s, blocks);
    if (!slips || !(f.spring.limit > 0)) continue;
    const Mat3 plane = f.spring.curvature();
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        for (std::size_t e = 0; e < 9; ++e)
          blocks[i * (i + 1) / 2 + j].m[e] += f.weight[i] * f.weight[j] * plane.m[e];
      }
    }
  }
}

void ContactPool::accept(const StencilRequest& q, std::span<double> memory) const {
  const Frames now = frames(q);
  for (Index s = 0; s < stencils(); ++s) {
    const FrictionSpring spring = friction(q, now, s).spring;
    const Vec3 f = now.now.inverse * spring.pull();
    double* m = memory.data() + static_cast<std::size_t>(memory_per_point()) * at(s);
    for (int i = 0; i < 3; ++i) m[i] = f[i];
    if (friction_.memory() > 0) m[3] = spring.slips() ? 1 : 0;
  }
}

}  // namespace isochor
