#include "constraints/contact/surface/edge_contact_pool.h"

#include <algorithm>
#include <cmath>

#include "constraints/contact/friction/turning_frame.h"
#include "engine/base/text.h"

namespace isochor {

namespace {

double norm(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

}  // namespace

EdgeContactPool::EdgeContactPool(std::shared_ptr<const Setup> setup, std::vector<Index> partner)
    : setup_(std::move(setup)), partner_(std::move(partner)) {
  for (Index s = 0; s < static_cast<Index>(partner_.size()); ++s) {
    if (partner_[at(s)] >= 0)
      nodes_.push(setup_->edges->nodes(s, partner_[at(s)]));
    else
      nodes_.push({});
  }
  finish_topology();
}

std::array<Vec3, kPairNodes> EdgeContactPool::places(Index s, std::span<const Vec3> x) const {
  std::array<Vec3, kPairNodes> out;
  const auto nodes = nodes_[s];
  for (std::size_t i = 0; i < kPairNodes; ++i) out[i] = x[at(nodes[i])];
  return out;
}

Vec3 EdgeContactPool::push(Index s, double multiplier, std::span<const Vec3> x) const {
  const auto slope = edge_slopes(places(s, x), gap(s, x), setup_->offset);
  Vec3 out{};
  for (std::size_t i = 0; i < kEdgeNodes; ++i) out -= multiplier * slope[i];
  return out;
}

Mat3 EdgeContactPool::axes(Index s, std::span<const Vec3> x) const {
  const auto& n = (*setup_->edges)[s].node;
  const Vec3 p = x[at(n[1])] - x[at(n[0])];
  const Vec3 out = cross(p, x[at(n[2])] - x[at(n[0])]) - cross(p, x[at(n[3])] - x[at(n[0])]);
  return turning_axes(p, out);
}

Vec3 EdgeContactPool::kept_pull(Index s, std::span<const double> memory, std::span<const Vec3> x) const {
  if (memory.empty() || !setup_->friction.any()) return {};
  const double* m = memory.data() + static_cast<std::size_t>(memory_per_edge()) * at(s);
  if (m[1] == 0 && m[2] == 0 && m[3] == 0) return {};
  return axes(s, x) * Vec3{m[1], m[2], m[3]};
}

double EdgeContactPool::coefficient(Index s, std::span<const double> memory) const {
  const auto place = static_cast<std::size_t>(memory_per_edge()) * at(s) + 4;
  return setup_->friction.coefficient(place < memory.size() ? memory.data() + place : nullptr);
}

// As in SurfaceContactPool: without an increment what is left is the pull that the last step ended with.
EdgeContactPool::Friction EdgeContactPool::friction(const StencilRequest& q, Index s) const {
  Friction f;
  f.spring.stiffness = setup_->stick[at(s)];
  if (q.lag.x.empty()) {
    const Vec3 kept = kept_pull(s, q.memory, q.x);
    f.spring.limit = norm(kept);
    f.spring.z = (1 / f.spring.stiffness) * kept;
    return f;
  }
  f.gap = gap(s, q.lag.x);
  // Edges that do not meet have no normal force, wherever their places are.
  if (f.gap.weight == 0) return f;
  f.mu = coefficient(s, q.memory);
  f.spring.limit = f.mu * f.gap.weight * std::max(0.0, -q.lag.function_multiplier[at(s)]);
  f.spring.normal = f.gap.normal;
  const auto nodes = nodes_[s];
  Vec3 slip = (1 / f.spring.stiffness) * kept_pull(s, q.memory, q.lag.x);
  for (std::size_t i = 0; i < kPairNodes && !q.increment.before.empty(); ++i)
    slip += f.gap.share(i) * (q.x[at(nodes[i])] - q.increment.before[at(nodes[i])]);
  f.whole = slip;
  f.spring.z = slip - dot(slip, f.gap.normal) * f.gap.normal;
  return f;
}

void EdgeContactPool::evaluate(const StencilRequest& q, const StencilSlots& slots) const {
  const bool slips = setup_->friction.any() && !q.lag.x.empty();
  for (Index s = q.begin; s < q.end; ++s) {
    slots.energy[at(s)] = 0;
    if (!has_partner(s)) {
      slots.value[at(s)] = setup_->open;
      continue;
    }
    const auto x = places(s, q.x);
    const EdgeGap here = edge_gap(x, setup_->offset);
    slots.value[at(s)] = here.value;
    Friction f;
    if (setup_->friction.any()) {
      f = friction(q, s);
      slots.energy[at(s)] = f.spring.energy();
    }
    if (q.want == Want::value) continue;
    const std::size_t first = at(nodes_.offset[at(s)]);
    const double multiplier = q.function_multiplier[at(s)];
    const bool rubs = slips && f.spring.limit > 0;
    const Vec3 force = rubs ? f.spring.pull() : Vec3{};
    const auto slope = edge_slopes(x, here, setup_->offset);
    std::array<double, kPairNodes> rub{};
    for (std::size_t i = 0; i < kPairNodes; ++i) {
      rub[i] = rubs ? f.gap.share(i) : 0;
      slots.jacobian[first + i] = slope[i];
      slots.gradient[first + i] = multiplier * slope[i] + rub[i] * force;
    }
    if (q.want != Want::hessian) continue;
    Mat3* blocks = slots.hessian.data() + hessian_offset()[at(s)];
    std::fill_n(blocks, kPairNodes * (kPairNodes + 1) / 2, Mat3{});
    // Definite without the curvature of the gap.
    if (multiplier != 0 && q.definiteness == Definiteness::exact)
      add_edge_curvature(x, here, setup_->offset, multiplier, blocks);
    if (!rubs) continue;
    const Mat3 plane = f.spring.curvature();
    for (std::size_t i = 0; i < kPairNodes; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        for (std::size_t e = 0; e < 9; ++e) blocks[i * (i + 1) / 2 + j].m[e] += rub[i] * rub[j] * plane.m[e];
      }
    }
  }
}

void EdgeContactPool::accept(const StencilRequest& q, std::span<double> memory) const {
  const auto per = static_cast<std::size_t>(memory_per_edge());
  for (Index s = 0; s < stencils(); ++s) {
    double* m = memory.data() + per * at(s);
    m[0] = partner_[at(s)] + 1;
    if (per == 1) continue;
    Vec3 own{};
    bool slips = false;
    if (has_partner(s)) {
      const Friction f = friction(q, s);
      if (f.spring.limit > 0) own = transposed_times(axes(s, q.x), f.spring.pull());
      slips = f.spring.slips();
    }
    for (int i = 0; i < 3; ++i) m[1 + i] = own[i];
    if (per > 4) m[4] = slips ? 1 : 0;
  }
}

FollowAnswer EdgeContactPool::followed(const FollowRequest& q) const {
  const SkinEdges& edges = *setup_->edges;
  const double small = 1e-3 * edges.size();
  std::vector<SkinEdges::Finding> found(partner_.size());
  std::vector<Index> base = partner_;
  if (!q.memory.empty()) {
    const auto per = static_cast<std::size_t>(memory_per_edge());
    for (std::size_t s = 0; s < base.size(); ++s) base[s] = static_cast<Index>(q.memory[per * s]) - 1;
  }
  edges.search(q.from, q.x, reach(), setup_->offset, base, q.parallel, found);
  FollowAnswer answer;
  bool needed = false;
  std::vector<Index> target = base;
  for (Index s = 0; s < stencils(); ++s) {
    const SkinEdges::Finding& f = found[at(s)];
    const Index c = base[at(s)];
    if (f.crossed >= 0) {
      // Far behind what it went through: known, or unseen.
      if (c == f.crossed || base[at(f.crossed)] == s) {
        const bool held = edges.gap(s, f.crossed, q.x, setup_->offset).value < 0;
        if (!held) ++(q.solved ? answer.passing : answer.crossed);
      } else {
        target[at(s)] = f.crossed;
        ++answer.crossed;
        needed = true;
      }
      continue;
    }
    const double present = c >= 0 ? edges.gap(s, c, q.x, setup_->offset).value : setup_->open;
    if (f.deepest == c) continue;
    const bool mutual = f.deepest >= 0 && base[at(f.deepest)] == s;
    // What is in contact stays together while the other one's stencil sees to what comes in addition; and
    // no stencil joins in where that one is pressed in already, since it would bring energy with it.
    if (f.deepest < 0 ? present < 0 : mutual && (present < 0 || f.before < -small)) continue;
    target[at(s)] = f.deepest;
    if (f.deepest < 0) continue;
    if (!q.solved)
      needed = needed || f.gap.distance - setup_->offset < 0.2 * reach();
    else
      needed = needed || (f.gap.value < 0 && std::abs(f.gap.value - present) > small);
  }
  if (!needed) target = base;
  if (target != partner_) answer.pool = std::make_shared<EdgeContactPool>(setup_, std::move(target));
  return answer;
}

Result<std::shared_ptr<const StencilPool>> EdgeContactPool::restored(std::span<const double> memory) const {
  const auto per = static_cast<std::size_t>(memory_per_edge());
  std::vector<Index> kept(partner_.size());
  for (std::size_t s = 0; s < kept.size(); ++s) {
    const double kept_number = memory[per * s];
    if (!(kept_number >= 0 && kept_number <= stencils()) || kept_number != std::floor(kept_number)) {
      return Error{"contact \"" + setup_->name + "\" is said to be close to edge number " +
                   number(kept_number - 1) + " of " + std::to_string(stencils())};
    }
    kept[s] = static_cast<Index>(kept_number) - 1;
  }
  return std::shared_ptr<const StencilPool>(std::make_shared<EdgeContactPool>(setup_, std::move(kept)));
}

}  // namespace isochor
