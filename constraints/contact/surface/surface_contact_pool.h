// Stencils of points on moving surfaces against the triangles that are close to them.
#pragma once

#include "constraints/contact/friction/friction_spring.h"
#include "constraints/contact/surface/skin.h"
#include "engine/system/pool.h"

namespace isochor {

// One stencil a point of the skin and one function, its signed distance to a patch of the other surface less
// an offset [m]; its multiplier is minus the normal force. The nodes are those of the point, then those of
// the patch: a triangle and its neighbors across edges, among which the nearest place is found at every
// evaluation. Points that nothing is close to have no nodes, and a gap that is never closed. Friction as in
// ContactPool, the pull of the last step turning with the triangle of the point, whose corners are nodes of
// the stencil as well where friction is coupled.
class SurfaceContactPool final : public StencilPool {
 public:
  // What pools that replace each other share.
  struct Setup {
    std::string name;
    std::shared_ptr<const Skin> skin;
    double offset = 0;  // [m]
    FrictionLaw friction;
    std::vector<double> stick;  // by point: stiffness of friction that sticks [N/m]
    double open = 1;            // gap of points that nothing is close to [m]
    bool coupled = false;
  };
  // `center`: by point the triangle its patch is around, or -1.
  SurfaceContactPool(std::shared_ptr<const Setup> setup, std::vector<Index> center);

  std::string_view name() const override { return setup_->name; }
  bool has_energy() const override { return setup_->friction.any(); }
  int functions() const override { return 1; }
  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override;

  bool has_lag() const override { return setup_->friction.any(); }
  bool couples() const override { return setup_->coupled && has_lag(); }
  // surface_coupling.cpp
  void lag_derivatives(const StencilRequest& request, const LagSlots& slots) const override;
  // By point: one more than the center, then the pull in the axes of its triangle and what the law keeps.
  int memory() const override { return memory_per_point() * stencils(); }
  void accept(const StencilRequest& request, std::span<double> memory) const override;
  bool follows() const override { return true; }
  FollowAnswer followed(const FollowRequest& request) const override;
  Result<std::shared_ptr<const StencilPool>> restored(std::span<const double> memory) const override;

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
    double mu = 0;  // coefficient of this step
    PatchPoint near;
    Vec3 whole{};  // slip and stretch before they are projected on the tangent plane
  };
  // Nodes of a stencil that its gap depends on; those behind them only turn the pull that is kept.
  std::size_t gap_nodes(Index s) const { return setup_->skin->points()[at(s)].nodes + patch_[at(s)].nodes; }
  Vec3 kept_pull_rate(Index s, std::span<const double> memory, std::span<const Vec3> x, Index node,
                      const Vec3& rate) const;
  double coefficient(Index s, std::span<const double> memory) const;
  int memory_per_point() const { return setup_->friction.any() ? 4 + setup_->friction.memory() : 1; }
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
