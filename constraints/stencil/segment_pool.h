// Stencils of straight segments between embedded points: how much longer they are than at rest.
#pragma once

#include "engine/scene/embedding.h"
#include "engine/system/pool.h"

namespace isochor {

// One function a segment, |sum_a c_a x_a + o| - l0 [m], with the difference of two embedded points in c and a
// fixed end in o. Its Hessian times a tension >= 0 has no negative eigenvalue.
class SegmentPool final : public StencilPool {
 public:
  SegmentPool(std::string name, bool anchored) : name_(std::move(name)), anchored_(anchored) {}
  // From `first` to `second`; refused when they coincide at rest.
  Result<void> add(const PointInBody& first, const PointInBody& second, std::span<const Vec3> rest);
  // Between a point of the body and a fixed place in space.
  Result<void> add_anchor(const PointInBody& point, const Vec3& place, std::span<const Vec3> rest);
  void finish() { finish_topology(); }

  std::string_view name() const override { return name_; }
  StencilShape shape() const override { return {.functions = 1}; }
  bool sees_rigid_motion() const override { return anchored_; }
  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override;

  double rest_length(Index segment) const { return rest_length_[at(segment)]; }
  double rest_length() const;
  double length(Index segment, std::span<const Vec3> x) const;
  double length(std::span<const Vec3> x) const;

 private:
  Result<void> push(const PointInBody& chord, const Vec3& offset, std::span<const Vec3> rest);
  Vec3 chord(Index segment, std::span<const Vec3> x) const;

  std::string name_;
  bool anchored_;
  std::vector<double> coefficient_, rest_length_;
  std::vector<Vec3> offset_;
};

}  // namespace isochor
