#include "constraints/contact/surface/surface_contact_pool.h"

#include <algorithm>
#include <cmath>

#include "constraints/contact/friction/turning_frame.h"
#include "engine/base/text.h"

namespace isochor {

namespace {

constexpr std::size_t kMost = kFaceNodes + kPatchNodes + 3;  // nodes of a stencil
constexpr double kSame = 1e-3;  // difference of distances over the size of a face that does not matter

double norm(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

}  // namespace

SurfaceContactPool::SurfaceContactPool(std::shared_ptr<const Setup> setup, std::vector<Index> center)
    : setup_(std::move(setup)), center_(std::move(center)) {
  const Skin& skin = *setup_->skin;
  patch_.resize(center_.size());
  for (Index s = 0; s < static_cast<Index>(center_.size()); ++s) {
    std::array<Index, kMost> nodes{};
    std::size_t count = 0;
    if (center_[at(s)] >= 0) {
      const SkinPoint& point = skin.points()[at(s)];
      for (std::size_t k = 0; k < point.nodes; ++k) nodes[count++] = point.node[k];
      const Skin::Around around = skin.around(center_[at(s)], s);
      for (std::size_t k = 0; k < around.patch.nodes; ++k) nodes[count++] = around.node[k];
      patch_[at(s)] = around.patch;
      for (const Index corner : skin.corners(skin.triangles_at(s)[0])) {
        const auto end = nodes.begin() + static_cast<std::ptrdiff_t>(count);
        if (couples() && std::find(nodes.begin(), end, corner) == end) nodes[count++] = corner;
      }
    }
    nodes_.push(std::span(nodes).first(count));
  }
  finish_topology();
}

PatchPoint SurfaceContactPool::nearest(Index s, std::span<const Vec3> x) const {
  const SkinPoint& point = setup_->skin->points()[at(s)];
  const auto nodes = nodes_[s].subspan(point.nodes, patch_[at(s)].nodes);
  std::array<Vec3, kPatchNodes> corner{};
  for (std::size_t k = 0; k < nodes.size(); ++k) corner[k] = x[at(nodes[k])];
  return nearest_on_patch(point.position(x), std::span(corner).first(nodes.size()), patch_[at(s)]);
}

double SurfaceContactPool::share(Index s, std::size_t i, const PatchPoint& near) const {
  const SkinPoint& point = setup_->skin->points()[at(s)];
  if (i >= gap_nodes(s)) return 0;
  return i < point.nodes ? point.weight[i] : -near.weight[i - point.nodes];
}

// Turn with the first triangle of the point.
Mat3 SurfaceContactPool::axes(Index s, std::span<const Vec3> x) const {
  const auto& c = setup_->skin->corners(setup_->skin->triangles_at(s)[0]);
  const Vec3 u = x[at(c[1])] - x[at(c[0])], v = x[at(c[2])] - x[at(c[0])];
  return turning_axes(u, cross(u, v));
}

Vec3 SurfaceContactPool::kept_pull(Index s, std::span<const double> memory, std::span<const Vec3> x) const {
  if (memory.empty() || !setup_->friction.any()) return {};
  const double* m = memory.data() + static_cast<std::size_t>(memory_per_point()) * at(s);
  if (m[1] == 0 && m[2] == 0 && m[3] == 0) return {};
  return axes(s, x) * Vec3{m[1], m[2], m[3]};
}

double SurfaceContactPool::coefficient(Index s, std::span<const double> memory) const {
  const auto place = static_cast<std::size_t>(memory_per_point()) * at(s) + 4;
  return setup_->friction.coefficient(place < memory.size() ? memory.data() + place : nullptr);
}

// As in ContactPool: without an increment what is left is the pull that the last step ended with.
SurfaceContactPool::Friction SurfaceContactPool::friction(const StencilRequest& q, Index s) const {
  Friction f;
  f.spring.stiffness = setup_->stick[at(s)];
  if (q.lag.x.empty()) {
    const Vec3 kept = kept_pull(s, q.memory, q.x);
    f.spring.limit = norm(kept);
    f.spring.z = (1 / f.spring.stiffness) * kept;
    return f;
  }
  const Vec3 kept = kept_pull(s, q.memory, q.lag.x);
  f.near = nearest(s, q.lag.x);
  f.mu = coefficient(s, q.memory);
  f.spring.limit = f.mu * std::max(0.0, -q.lag.function_multiplier[at(s)]);
  f.spring.normal = f.near.normal;
  const auto nodes = nodes_[s];
  Vec3 slip = (1 / f.spring.stiffness) * kept;
  for (std::size_t i = 0; i < nodes.size() && !q.increment.before.empty(); ++i)
    slip += share(s, i, f.near) * (q.x[at(nodes[i])] - q.increment.before[at(nodes[i])]);
  f.whole = slip;
  f.spring.z = slip - dot(slip, f.near.normal) * f.near.normal;
  return f;
}

void SurfaceContactPool::evaluate(const StencilRequest& q, const StencilSlots& slots) const {
  const bool slips = setup_->friction.any() && !q.lag.x.empty();
  for (Index s = q.begin; s < q.end; ++s) {
    slots.energy[at(s)] = 0;
    if (!close(s)) {
      slots.value[at(s)] = setup_->open;
      continue;
    }
    const auto nodes = nodes_[s];
    const std::size_t n = nodes.size(), first = at(nodes_.offset[at(s)]);
    const PatchPoint near = nearest(s, q.x);
    const bool exists = std::isfinite(near.distance);
    slots.value[at(s)] = exists ? near.distance - setup_->offset : setup_->open;
    Friction f;
    if (setup_->friction.any()) {
      f = friction(q, s);
      slots.energy[at(s)] = f.spring.energy();
    }
    if (q.want == Want::value) continue;
    const double multiplier = q.function_multiplier[at(s)];
    const Vec3 force = slips ? f.spring.pull() : Vec3{};
    std::array<double, kMost> share_of{}, rub{};
    for (std::size_t i = 0; i < n; ++i) {
      share_of[i] = share(s, i, near);
      rub[i] = slips ? share(s, i, f.near) : 0;
      slots.jacobian[first + i] = share_of[i] * near.normal;
      slots.gradient[first + i] = multiplier * share_of[i] * near.normal + rub[i] * force;
    }
    if (q.want != Want::hessian) continue;
    Mat3* blocks = slots.hessian.data() + hessian_offset()[at(s)];
    std::fill_n(blocks, n * (n + 1) / 2, Mat3{});
    if (multiplier != 0 && exists) {
      add_patch_curvature(near, multiplier, q.definiteness != Definiteness::exact,
                          std::span(share_of).first(gap_nodes(s)), setup_->skin->points()[at(s)].nodes,
                          blocks);
    }
    if (!slips || !(f.spring.limit > 0)) continue;
    const Mat3 plane = f.spring.curvature();
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        for (std::size_t e = 0; e < 9; ++e) blocks[i * (i + 1) / 2 + j].m[e] += rub[i] * rub[j] * plane.m[e];
      }
    }
  }
}

void SurfaceContactPool::accept(const StencilRequest& q, std::span<double> memory) const {
  const auto per = static_cast<std::size_t>(memory_per_point());
  for (Index s = 0; s < stencils(); ++s) {
    double* m = memory.data() + per * at(s);
    m[0] = center_[at(s)] + 1;
    if (per == 1) continue;
    const FrictionSpring spring = close(s) ? friction(q, s).spring : FrictionSpring{};
    const Vec3 own = close(s) ? transposed_times(axes(s, q.x), spring.pull()) : Vec3{};
    for (int i = 0; i < 3; ++i) m[1 + i] = own[i];
    if (per > 4) m[4] = spring.slips() ? 1 : 0;
  }
}

PatchPoint SurfaceContactPool::seen_from(Index s, Index center, std::span<const Vec3> x) const {
  const Skin::Around around = setup_->skin->around(center, s);
  std::array<Vec3, kPatchNodes> corner{};
  for (std::size_t k = 0; k < around.patch.nodes; ++k) corner[k] = x[at(around.node[k])];
  return nearest_on_patch(setup_->skin->points()[at(s)].position(x),
                          std::span(corner).first(around.patch.nodes), around.patch);
}

// Whether the nearest place is beyond the patch by more than a quarter of a face, or by anything where the
// patch is not flat. Up to there what slides on a flat surface needs no new stencils, which cost an analysis.
bool SurfaceContactPool::reaches_out(const PatchPoint& near, Index s, Index center,
                                     std::span<const Vec3> x) const {
  constexpr double flat = 0.999;  // cosine of 2.5 degrees
  const Skin::Around around = setup_->skin->around(center, s);
  const auto normal = [&](const std::array<std::uint8_t, 3>& c) {
    const Vec3 a = x[at(around.node[c[0]])];
    return cross(x[at(around.node[c[1]])] - a, x[at(around.node[c[2]])] - a);
  };
  const Vec3 middle = normal(around.patch.corner[0]);
  for (std::size_t t = 1; t < around.patch.triangles; ++t) {
    const Vec3 n = normal(around.patch.corner[t]);
    if (!around.patch.side[t] && dot(n, middle) < flat * norm(n) * norm(middle)) return true;
  }
  return around.patch.face > 3 ||
         std::any_of(near.weight.begin(), near.weight.end(), [](double w) { return w < -0.25; });
}

FollowAnswer SurfaceContactPool::followed(const FollowRequest& q) const {
  const Skin& skin = *setup_->skin;
  const double deep = 0.5 * skin.size();
  std::vector<Skin::Finding> found(center_.size());
  std::vector<Index> base = center_;
  if (!q.memory.empty()) {
    const auto per = static_cast<std::size_t>(memory_per_point());
    for (std::size_t s = 0; s < base.size(); ++s) base[s] = static_cast<Index>(q.memory[per * s]) - 1;
  }
  skin.search(q.from, q.x, reach(), base, q.parallel, found);
  FollowAnswer answer;
  bool needed = false;
  std::vector<Index> target(center_.size(), -1);
  for (Index s = 0; s < stencils(); ++s) {
    const Skin::Finding& f = found[at(s)];
    const Index c = base[at(s)];
    target[at(s)] = f.nearest;
    const bool seen = f.nearest >= 0 && skin.in_patch(c, f.nearest, s);
    if (f.crossed >= 0 && !(f.nearest >= 0 && std::abs(f.distance) < deep)) {
      // Through a triangle and far behind it, rather than a little into what is nearest now, or back in
      // front.
      target[at(s)] = f.crossed;
      if (!skin.in_patch(c, f.crossed, s)) {
        ++answer.crossed;
        needed = true;
        continue;
      }
      target[at(s)] = c;
      if (q.solved && center_[at(s)] == c && nearest(s, q.x).distance >= 0) ++answer.passing;
      continue;
    }
    if (f.nearest < 0 && c >= 0 && center_[at(s)] == c) {
      // Deeper than the search reaches; or beside, or turned away from, what it was close to.
      const double present = nearest(s, q.x).distance;
      const bool inside = present < setup_->offset;
      if (present < -0.9 * reach() && skin.facing(s, c, q.x)) target[at(s)] = c;
      needed = needed || (inside && target[at(s)] != c);
    }
    if (f.nearest < 0 || seen) continue;
    // Beside a sharp edge the patch around it says that the point is outside; beyond a corner its planes may
    // be above a point that is not inside.
    const double distance = std::max(f.distance, seen_from(s, f.nearest, q.x).distance);
    const double gap = distance - setup_->offset;
    if (c < 0) {
      needed = needed || gap < (q.solved ? 0 : 0.4 * reach());
      continue;
    }
    const PatchPoint here = seen_from(s, c, q.x);
    const bool differs = std::abs(distance - here.distance) > kSame * skin.size();
    if (q.solved)
      needed = needed || (std::min(distance, here.distance) < setup_->offset && differs);
    else
      needed = needed || (gap < 0.4 * reach() && (differs || reaches_out(here, s, c, q.x)));
  }
  if (!needed) target = base;
  if (target != center_) answer.pool = std::make_shared<SurfaceContactPool>(setup_, std::move(target));
  return answer;
}

Result<std::shared_ptr<const StencilPool>> SurfaceContactPool::restored(
    std::span<const double> memory) const {
  const auto per = static_cast<std::size_t>(memory_per_point());
  std::vector<Index> kept(center_.size());
  for (std::size_t s = 0; s < kept.size(); ++s) {
    const double kept_number = memory[per * s];
    if (!(kept_number >= 0 && kept_number <= setup_->skin->triangles()) ||
        kept_number != std::floor(kept_number)) {
      return Error{"contact \"" + setup_->name + "\" is said to be close to triangle number " +
                   number(kept_number - 1) + " of " + std::to_string(setup_->skin->triangles())};
    }
    kept[s] = static_cast<Index>(kept_number) - 1;
  }
  return std::shared_ptr<const StencilPool>(std::make_shared<SurfaceContactPool>(setup_, std::move(kept)));
}

}  // namespace isochor
