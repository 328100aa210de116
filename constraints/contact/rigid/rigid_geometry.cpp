#include "constraints/contact/rigid/rigid_geometry.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace isochor {

namespace {

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

bool PlacedShape::moves(double t0, double t1) const {
  return moves() && !same_pose(frame(t0, {}), frame(t1, {}));
}

void RigidGeometry::add(Index node, double stick, double size, const Vec3& inset) {
  std::vector<Index> nodes = {node};
  if (shape_points()) nodes.insert(nodes.end(), shape_points()->node.begin(), shape_points()->node.end());
  nodes_.push(nodes);
  point_.push_back({stick, size, inset, 0, {}, {}});
}

void RigidGeometry::add(const ControlPoints& body, const Vec3& own, double offset, double stick) {
  std::vector<Index> nodes(body.node.begin(), body.node.end());
  if (shape_points()) nodes.insert(nodes.end(), shape_points()->node.begin(), shape_points()->node.end());
  nodes_.push(nodes);
  point_.push_back({stick, 0, {}, offset, body, own});
}

Vec3 RigidGeometry::position(Index s, std::span<const Vec3> x) const {
  const auto nodes = nodes_[s];
  const RigidPoint& point = point_[at(s)];
  if (!point.rider) return x[at(nodes[0])];
  Vec3 p{};
  for (std::size_t a = 0; a < 4; ++a) p += point.rider->weight(a, point.own) * x[at(nodes[a])];
  return p;
}

std::array<double, RigidGeometry::kMost> RigidGeometry::weights(Index s, const Vec3& own) const {
  std::array<double, kMost> w{};
  const RigidPoint& point = point_[at(s)];
  const std::size_t count = point.rider ? 4 : 1;
  w[0] = 1;
  for (std::size_t a = 0; point.rider && a < 4; ++a) w[a] = point.rider->weight(a, point.own);
  for (std::size_t a = 0; shape_points() && a < 4; ++a) w[count + a] = -shape_points()->weight(a, own);
  return w;
}

RigidGeometry::Frames RigidGeometry::frames(const StencilRequest& q) const {
  Frames f;
  f.x = q.x;
  f.now = frame(q.increment.t1, q.x);
  f.lag = q.lag.x.empty() ? f.now : frame(q.increment.t1, q.lag.x);
  f.before = q.increment.before.empty() ? f.now : frame(q.increment.t0, q.increment.before);
  return f;
}

RigidGeometry::Gap RigidGeometry::gap_at(const Frames& frames, Index s, Want want) const {
  Gap gap;
  gap.own = own_place(s, frames.now, frames.x);
  gap.distance = distance_to(shape(), gap.own);
  gap.value = gap.distance.value - point_[at(s)].offset;
  if (want == Want::value) return gap;
  gap.normal = transposed_times(frames.now.inverse, gap.distance.normal);
  gap.weight = weights(s, gap.own);
  return gap;
}

// multiplier times the second derivative of the gap. From A dy = dp - sum w_a dx_a, w_a affine in y, comes
// A d2y = -2 dA dy, so beside the curvature of the shape there are cross terms with its control points.
void RigidGeometry::add_curvature(const StencilRequest& q, const Frames& frames, const Gap& gap, Index s,
                                  Mat3* blocks) const {
  const Mat3& inverse = frames.now.inverse;
  const double multiplier = q.function_multiplier[at(s)];
  double factor = multiplier;
  if (q.definiteness == Definiteness::projected) factor = std::max(multiplier, 0.0);
  if (q.definiteness == Definiteness::absolute) factor = std::abs(multiplier);
  Mat3 curvature = pulled_back(inverse, gap.distance.curvature);
  if (!is_convex(shape()) && q.definiteness != Definiteness::exact) {
    // Its eigenvalues have either sign, whatever that of the multiplier.
    for (double& v : curvature.m) v *= multiplier;
    curvature = made_definite(curvature, q.definiteness);
    factor = 1;
  }
  const auto& c = gap.weight;
  const std::size_t n = nodes_[s].size(), first = point_[at(s)].rider ? 4 : 1;
  // The cross terms are indefinite: left out where a definite matrix is asked for.
  const bool cross_terms = shape_points() && q.definiteness == Definiteness::exact;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      Mat3& block = blocks[i * (i + 1) / 2 + j];
      for (std::size_t k = 0; k < 9; ++k) block.m[k] += factor * c[i] * c[j] * curvature.m[k];
      if (!cross_terms) continue;
      if (i >= first) {
        const Vec3 e = transposed_times(inverse, shape_points()->slope(i - first));
        add_outer(block, -multiplier * c[j], gap.normal, e);
      }
      if (j >= first) {
        const Vec3 e = transposed_times(inverse, shape_points()->slope(j - first));
        add_outer(block, -multiplier * c[i], e, gap.normal);
      }
    }
  }
}

}  // namespace isochor
