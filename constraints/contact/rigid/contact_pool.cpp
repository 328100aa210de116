#include "constraints/contact/rigid/contact_pool.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace isochor {

namespace {

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

ContactPool::ContactPool(std::string name, Obstacle shape, FrictionLaw friction,
                         std::optional<ControlPoints> points, bool coupled)
    : FrictionalPool(std::move(name), {friction}, coupled), shape_(std::move(shape)), points_(points) {}

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
  f.x = q.x;
  f.now = frame(q.increment.t1, q.x);
  f.lag = q.lag.x.empty() ? f.now : frame(q.increment.t1, q.lag.x);
  f.before = q.increment.before.empty() ? f.now : frame(q.increment.t0, q.increment.before);
  return f;
}

ContactPool::Gap ContactPool::gap_at(const Frames& frames, Index s, Want want) const {
  Gap gap;
  gap.own = own_place(s, frames.now, frames.x);
  gap.distance = distance_to(shape_, gap.own);
  gap.value = gap.distance.value - offset_[at(s)];
  if (want == Want::value) return gap;
  gap.normal = transposed_times(frames.now.inverse, gap.distance.normal);
  gap.weight = weights(s, gap.own);
  return gap;
}

// multiplier times the second derivative of the gap. From A dy = dp - sum w_a dx_a, w_a affine in y, comes
// A d2y = -2 dA dy, so beside the curvature of the shape there are cross terms with its control points.
void ContactPool::add_curvature(const StencilRequest& q, const Frames& frames, const Gap& gap, Index s,
                                Mat3* blocks) const {
  const Mat3& inverse = frames.now.inverse;
  const double multiplier = q.function_multiplier[at(s)];
  double factor = multiplier;
  if (q.definiteness == Definiteness::projected) factor = std::max(multiplier, 0.0);
  if (q.definiteness == Definiteness::absolute) factor = std::abs(multiplier);
  Mat3 curvature = pulled_back(inverse, gap.distance.curvature);
  if (!is_convex(shape_) && q.definiteness != Definiteness::exact) {
    // Its eigenvalues have either sign, whatever that of the multiplier.
    for (double& v : curvature.m) v *= multiplier;
    curvature = made_definite(curvature, q.definiteness);
    factor = 1;
  }
  const auto& c = gap.weight;
  const std::size_t n = nodes_[s].size(), first = rider_[at(s)] ? 4 : 1;
  // The cross terms are indefinite: left out where a definite matrix is asked for.
  const bool cross_terms = points_ && q.definiteness == Definiteness::exact;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      Mat3& block = blocks[i * (i + 1) / 2 + j];
      for (std::size_t k = 0; k < 9; ++k) block.m[k] += factor * c[i] * c[j] * curvature.m[k];
      if (!cross_terms) continue;
      if (i >= first) {
        const Vec3 e = transposed_times(inverse, points_->slope(i - first));
        add_outer(block, -multiplier * c[j], gap.normal, e);
      }
      if (j >= first) {
        const Vec3 e = transposed_times(inverse, points_->slope(j - first));
        add_outer(block, -multiplier * c[i], e, gap.normal);
      }
    }
  }
}

}  // namespace isochor
