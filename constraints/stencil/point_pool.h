// Stencils of points: how far a weighted sum of node positions is from where it was at rest.
#pragma once

#include "engine/scene/embedding.h"
#include "engine/system/pool.h"

namespace isochor {

// Three functions a stencil, d_k . sum_a w_a (x_a - X_a) along an orthonormal frame [m]. A point that rides
// on one body (weights that sum to one) may be held; the difference of two points (weights that sum to zero)
// ties them. Linear: no Hessian.
class PointPool final : public StencilPool {
 public:
  using Frame = std::array<Vec3, 3>;
  static constexpr Frame kAxes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};

  // `held`: the points are compared with places in space, which may hold a body in statics.
  PointPool(std::string name, bool held) : name_(std::move(name)), held_(held) {}
  void add(const PointInBody& point, const Frame& frame = kAxes) {
    nodes_.push(point.nodes);
    weight_.insert(weight_.end(), point.weight.begin(), point.weight.end());
    frame_.push_back(frame);
  }
  void finish() { finish_topology(); }

  std::string_view name() const override { return name_; }
  StencilShape shape() const override { return {.functions = 3}; }
  bool sees_rigid_motion() const override { return held_; }
  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override;

  const Frame& frame(Index stencil) const { return frame_[at(stencil)]; }

 private:
  std::string name_;
  bool held_;
  std::vector<double> weight_;
  std::vector<Frame> frame_;
};

// Appends the row that is function k of a stencil.
inline void add_point_row(RowPool& rows, Index stencil, int k, double compliance, double metric,
                          double measure) {
  const Index row = rows.rows(), function = 3 * stencil + k;
  rows.map.push(std::span(&function, 1));
  rows.weight.push_back(1);
  rows.metric.push_back(metric);
  rows.measure.push_back(measure);
  if (compliance > 0) rows.compliance.push_back({row, row, compliance});
}

}  // namespace isochor
