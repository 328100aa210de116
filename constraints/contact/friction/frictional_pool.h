// What all pools of contact do: gaps as functions of stencils, and friction as their energy.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "constraints/contact/friction/friction_memory.h"
#include "constraints/contact/friction/friction_point.h"
#include "engine/system/pool.h"

namespace isochor {

// One point a stencil and one function, its gap [m]; the multiplier is minus the normal force. Friction holds
// on to the lag, and keeps its pull in memory so that what sticks does not creep. A geometry has
//   Lists nodes()                          of every stencil
//   bool meets(s), double open()           whether something is close to the point; the gap where nothing is
//   double stick(s)                        stiffness of friction that sticks [N/m]
//   Frames frames(request)                 what all points share, at positions now and at those of the lag
//   Gap gap_at(frames, s, want)            .value, and .slope(i, factor): factor * d gap / d x_i
//   add_curvature(request, frames, gap, s, blocks)   multiplier times the second derivative of the gap
//   TouchAt touch(request, frames, s)      a Touch<N>, at the lag
//   Vec3 to_space(frames, s, own)          a vector in the axes that turn with the surface, at the lag
//   Vec3 to_own(frames, s, v)              and back, now
//   Rates rates(request, frames, s, touch) in the lag: .node(b), then for its coordinates e
//                                          .kept(own, e), rate of to_space(own), and .add(e, TouchRate&)
template <class Geometry>
class FrictionalPool : public StencilPool, public LaggedStencils, public RememberingStencils {
 public:
  const Geometry& geometry() const { return geometry_; }
  // The pull of friction that a step left, in the axes that turn with the surface, and in space [N].
  Vec3 kept_pull(Index s, std::span<const double> memory) const { return memory_.pull(s, memory); }
  template <class Frames>
  Vec3 kept_pull(const Frames& frames, Index s, std::span<const double> memory) const {
    const Vec3 own = memory_.pull(s, memory);
    return own == Vec3{} ? own : geometry_.to_space(frames, s, own);
  }

  std::string_view name() const final { return name_; }
  StencilShape shape() const final { return {.energy = rubs(), .functions = 1}; }
  void evaluate(const StencilRequest& request, const StencilSlots& slots) const final;

  bool couples() const final { return coupled_ && rubs(); }
  void lag_derivatives(const StencilRequest& request, const LagSlots& slots) const final;
  int memory() const final { return memory_.per_point() * stencils(); }
  void accept(const StencilRequest& request, std::span<double> memory) const override;

 protected:
  FrictionalPool(std::string name, Geometry geometry, FrictionMemory memory, bool coupled)
      : name_(std::move(name)), geometry_(std::move(geometry)), memory_(memory), coupled_(coupled) {
    nodes_ = geometry_.nodes();
    finish_topology();
  }
  const FrictionMemory& friction_memory() const { return memory_; }
  bool rubs() const { return memory_.law.any(); }
  // Of friction alone.
  StencilFacets friction_facets() const {
    if (!rubs()) return {};
    return {.lagged = this, .remembering = this};
  }

 private:
  template <class Frames>
  auto friction(const StencilRequest& request, const Frames& frames, Index s) const;
  template <class Point, class Rates>
  void differentiate(const Point& point, const Vec3& kept, Rates& rates, std::size_t n, Mat3* blocks) const;

  std::string name_;
  Geometry geometry_;
  FrictionMemory memory_;
  bool coupled_;
};

template <class Geometry>
template <class Frames>
auto FrictionalPool<Geometry>::friction(const StencilRequest& q, const Frames& frames, Index s) const {
  FrictionPoint<typename Geometry::TouchAt> f;
  if (!rubs()) return f;
  f.spring.stiffness = geometry_.stick(s);
  if (q.lag.x.empty()) {
    f.keep(kept_pull(frames, s, q.memory));
    return f;
  }
  const double pressing = std::max(0.0, -q.lag.function_multiplier[at(s)]);
  if (pressing == 0) return f;
  f.touch = geometry_.touch(q, frames, s);
  if (f.touch.share == 0) return f;
  f.mu = memory_.coefficient(s, q.memory);
  Vec3 slip{};
  if (!q.increment.before.empty()) {
    const auto nodes = nodes_[s];
    for (std::size_t i = 0; i < nodes.size(); ++i)
      slip += f.touch.weight[i] * (q.x[at(nodes[i])] - q.increment.before[at(nodes[i])]);
    slip -= f.touch.carried;
  }
  f.slide(pressing, slip + (1 / f.spring.stiffness) * kept_pull(frames, s, q.memory));
  return f;
}

template <class Geometry>
void FrictionalPool<Geometry>::evaluate(const StencilRequest& q, const StencilSlots& slots) const {
  const auto frames = geometry_.frames(q);
  // Results are read without slip: nothing moves against the friction that is left.
  const bool slides = rubs() && !q.lag.x.empty();
  for (Index s = q.begin; s < q.end; ++s) {
    slots.energy[at(s)] = 0;
    if (!geometry_.meets(s)) {
      slots.value[at(s)] = geometry_.open();
      continue;
    }
    const auto gap = geometry_.gap_at(frames, s, q.want);
    slots.value[at(s)] = gap.value;
    const auto f = friction(q, frames, s);
    if (rubs()) slots.energy[at(s)] = f.spring.energy();
    // The frame of a free rigid body may be flat on the way to where its points keep their distances.
    if (!std::isfinite(gap.value)) slots.energy[at(s)] = std::numeric_limits<double>::infinity();
    if (q.want == Want::value) continue;
    const std::size_t n = nodes_[s].size(), first = at(nodes_.offset[at(s)]);
    const double multiplier = q.function_multiplier[at(s)];
    const bool pulls = slides && f.rubs();
    const Vec3 pull = pulls ? f.spring.pull() : Vec3{};
    for (std::size_t i = 0; i < n; ++i) {
      slots.jacobian[first + i] = gap.slope(i, 1);
      slots.gradient[first + i] = gap.slope(i, multiplier) + f.touch.weight[i] * pull;
    }
    if (q.want != Want::hessian) continue;
    Mat3* blocks = slots.hessian.data() + hessian_offset()[at(s)];
    std::fill_n(blocks, n * (n + 1) / 2, Mat3{});
    geometry_.add_curvature(q, frames, gap, s, blocks);
    if (pulls) f.add_curvature(n, blocks);
  }
}

template <class Geometry>
void FrictionalPool<Geometry>::lag_derivatives(const StencilRequest& q, const LagSlots& slots) const {
  if (q.lag.x.empty()) return;
  const auto frames = geometry_.frames(q);
  for (Index s = q.begin; s < q.end; ++s) {
    if (!geometry_.meets(s)) continue;
    const auto f = friction(q, frames, s);
    if (!f.rubs()) continue;
    const std::size_t n = nodes_[s].size();
    const Vec3 by_multiplier = f.pull_by_multiplier();
    Vec3* column = slots.column.data() + nodes_.offset[at(s)];
    for (std::size_t a = 0; a < n; ++a) column[a] = f.touch.weight[a] * by_multiplier;
    auto rates = geometry_.rates(q, frames, s, f.touch);
    differentiate(f, memory_.pull(s, q.memory), rates, n, slots.block.data() + slots.block_offset[at(s)]);
  }
}

// Forces are weights times the pull: both change with the place, the pull with what is kept as well.
template <class Geometry>
template <class Point, class Rates>
void FrictionalPool<Geometry>::differentiate(const Point& f, const Vec3& kept, Rates& rates, std::size_t n,
                                             Mat3* blocks) const {
  const Vec3 pull = f.spring.pull();
  const bool turns = !(kept == Vec3{});
  for (std::size_t b = 0; b < n; ++b) {
    rates.node(b);
    for (int e = 0; e < 3; ++e) {
      TouchRate<Geometry::TouchAt::kNodes> rate;
      if (turns) rate.whole = (1 / f.spring.stiffness) * rates.kept(kept, e);
      rates.add(e, rate);
      const Vec3 pull_rate = f.pull_rate(rate);
      for (std::size_t a = 0; a < n; ++a) {
        const Vec3 force = f.touch.weight[a] * pull_rate + rate.weight[a] * pull;
        for (int i = 0; i < 3; ++i) blocks[a * n + b](i, e) = force[i];
      }
    }
  }
}

template <class Geometry>
void FrictionalPool<Geometry>::accept(const StencilRequest& q, std::span<double> memory) const {
  if (!rubs()) return;
  const auto frames = geometry_.frames(q);
  for (Index s = 0; s < stencils(); ++s) {
    Vec3 own{};
    bool slips = false;
    if (geometry_.meets(s)) {
      const auto f = friction(q, frames, s);
      if (f.rubs()) own = geometry_.to_own(frames, s, f.spring.pull());
      slips = f.spring.slips();
    }
    memory_.keep(s, own, slips, memory);
  }
}

}  // namespace isochor
