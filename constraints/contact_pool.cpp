#include "constraints/contact_pool.h"

#include <algorithm>
#include <cmath>

namespace isochor {

namespace {

double norm(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

Mat3 turned(const Mat3& R, const Mat3& m) {
  Mat3 half, out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) half(i, j) = R(i, 0) * m(0, j) + R(i, 1) * m(1, j) + R(i, 2) * m(2, j);
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      out(i, j) = half(i, 0) * R(j, 0) + half(i, 1) * R(j, 1) + half(i, 2) * R(j, 2);
  }
  return out;
}

Vec3 tangential(const Vec3& v, const Vec3& normal) {
  return v - dot(v, normal) * normal;
}

}  // namespace

void ContactPool::add(Index node, double stick) {
  nodes_.push({&node, 1});
  stick_.push_back(stick);
}

// Limit, tangent plane and stretch of the spring that stands for sticking friction. Without an increment
// there is no slip, and what is left is the pull that the last step ended with.
ContactPool::Friction ContactPool::friction(const StencilRequest& q, const Poses& poses, Index s) const {
  Friction f;
  const bool remembers = !q.memory.empty();
  const double* m = remembers ? q.memory.data() + 3 * at(s) : nullptr;
  const Vec3 kept = remembers ? poses.now.R * Vec3{m[0], m[1], m[2]} : Vec3{};
  if (q.lag.x.empty()) {
    f.limit = norm(kept);
    f.z = (1 / stick_[at(s)]) * kept;
    return f;
  }
  const auto node = at(nodes_[s][0]);
  f.limit = friction_ * std::max(0.0, -q.lag.function_multiplier[at(s)]);
  f.normal = poses.now.R * distance_to(obstacle_, poses.now.to_own(q.lag.x[node])).normal;
  Vec3 slip{};
  if (!q.increment.before.empty()) {
    slip = q.x[node] - poses.now.to_world(poses.before.to_own(q.increment.before[node]));
  }
  f.z = tangential(slip + (1 / stick_[at(s)]) * kept, f.normal);
  return f;
}

Vec3 ContactPool::pull(Index s, const Friction& f) const {
  const double stretch = norm(f.z);
  if (stick_[at(s)] * stretch <= f.limit) return stick_[at(s)] * f.z;
  return (f.limit / stretch) * f.z;
}

void ContactPool::evaluate(const StencilRequest& q, const StencilSlots& slots) const {
  const Poses now = poses(q.increment);
  for (Index s = q.begin; s < q.end; ++s) {
    const Distance d = distance_to(obstacle_, now.now.to_own(q.x[at(nodes_[s][0])]));
    slots.value[at(s)] = d.value;
    slots.energy[at(s)] = 0;
    Friction f;
    double stretch = 0, k = 0;
    bool sticks = true;
    if (friction_ > 0) {
      f = friction(q, now, s);
      k = stick_[at(s)];
      stretch = norm(f.z);
      sticks = k * stretch <= f.limit;
      slots.energy[at(s)] =
          sticks ? 0.5 * k * stretch * stretch : f.limit * stretch - 0.5 * f.limit * f.limit / k;
    }
    if (q.want == Want::value) continue;
    const Vec3 normal = now.now.R * d.normal;
    const double multiplier = q.function_multiplier[at(s)];
    slots.jacobian[at(s)] = normal;
    slots.gradient[at(s)] = multiplier * normal;
    // Results are read without slip: nothing moves against the friction that is left.
    const bool slips = friction_ > 0 && !q.lag.x.empty();
    if (slips) slots.gradient[at(s)] += pull(s, f);
    if (q.want != Want::hessian) continue;
    double factor = multiplier;
    if (q.definiteness == Definiteness::projected) factor = std::max(multiplier, 0.0);
    if (q.definiteness == Definiteness::absolute) factor = std::abs(multiplier);
    Mat3 h = turned(now.now.R, d.curvature);
    for (double& v : h.m) v *= factor;
    if (slips && f.limit > 0) {
      // Sticking: k in the tangent plane. Slipping: only across the direction of the slip.
      const double c = sticks ? k : f.limit / stretch;
      const Vec3 along = sticks ? Vec3{} : (1 / stretch) * f.z;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
          h(i, j) += c * ((i == j ? 1.0 : 0.0) - f.normal[i] * f.normal[j] - along[i] * along[j]);
      }
    }
    slots.hessian[static_cast<std::size_t>(hessian_offset()[at(s)])] = h;
  }
}

void ContactPool::accept(const StencilRequest& q, std::span<double> memory) const {
  const Poses now = poses(q.increment);
  for (Index s = 0; s < stencils(); ++s) {
    const Vec3 f = transposed_times(now.now.R, pull(s, friction(q, now, s)));
    for (int i = 0; i < 3; ++i) memory[3 * at(s) + static_cast<std::size_t>(i)] = f[i];
  }
}

Index ContactPool::passing(const StencilIncrement& increment, std::span<const Vec3> x,
                           std::span<Vec3> stopped) const {
  const Poses p = poses(increment);
  Index count = 0;
  for (Index s = 0; s < stencils(); ++s) {
    const auto node = at(nodes_[s][0]);
    Vec3 met{};
    if (!passes_through(obstacle_, p.before.to_own(increment.before[node]), p.now.to_own(x[node]), met)) {
      continue;
    }
    ++count;
    if (!stopped.empty()) stopped[node] = p.now.to_world(met);
  }
  return count;
}

}  // namespace isochor
