// Stencils of points on moving surfaces against the triangles that are close to them.
#pragma once

#include "constraints/friction_spring.h"
#include "constraints/skin.h"
#include "engine/pool.h"

namespace isochor {

// One stencil a point of the skin and one function, its signed distance to a patch of the other surface less
// an offset [m]; its multiplier is minus the normal force. The nodes are those of the point, then those of
// the patch: a triangle and its neighbors across edges, among which the nearest place is found at every
// evaluation. Points that nothing is close to have no nodes, and a gap that is never closed. Friction as in
// ContactPool, the pull of the last step turning with the triangle of the point.
class SurfaceContactPool final : public StencilPool {
 public:
  // What pools that replace each other share.
  struct Setup {
    std::string name;
    std::shared_ptr<const Skin> skin;
    double offset = 0;          // [m]
    double friction = 0;        // [-]
    std::vector<double> stick;  // by point: stiffness of friction that sticks [N/m]
    double open = 1;            // gap of points that nothing is close to [m]
  };
  // `center`: by point the triangle its patch is around, or -1.
  SurfaceContactPool(std::shared_ptr<const Setup> setup, std::vector<Index> center);

  std::string_view name() const override { return setup_->name; }
  bool has_energy() const override { return setup_->friction > 0; }
  int functions() const override { return 1; }
  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override;

  bool has_lag() const override { return setup_->friction > 0; }
  // By point: one more than the center, then the pull in the axes of its triangle.
  int memory() const override { return memory_per_point() * stencils(); }
  void accept(const StencilRequest& request, std::span<double> memory) const override;
  bool follows() const override { return true; }
  FollowAnswer followed(const FollowRequest& request) const override;

  const Setup& setup() const { return *setup_; }
  bool close(Index s) const { return center_[at(s)] >= 0; }
  // The nearest place and its distance, without the offset; of points that something is close to.
  PatchPoint nearest(Index s, std::span<const Vec3> x) const;
  // Share of node i of a stencil in the motion of the point relative to the patch.
  double share(Index s, std::size_t i, const PatchPoint& near) const;
  // The pull of friction that a step left, at positions x [N].
  Vec3 kept_pull(Index s, std::span<const double> memory, std::span<const Vec3> x) const;

 private:
  struct Friction {
    FrictionSpring spring;
    PatchPoint near;
  };
  int memory_per_point() const { return setup_->friction > 0 ? 4 : 1; }
  Friction friction(const StencilRequest& request, Index s) const;
  Mat3 axes(Index s, std::span<const Vec3> x) const;
  // The nearest place of a patch around a triangle.
  PatchPoint seen_from(Index s, Index center, std::span<const Vec3> x) const;
  bool reaches_out(const PatchPoint& near, Index s, Index center, std::span<const Vec3> x) const;
  double reach() const { return setup_->offset + 0.75 * setup_->skin->size(); }

  std::shared_ptr<const Setup> setup_;
  std::vector<Index> center_;
  std::vector<Patch> patch_;
};

}  // namespace isochor
