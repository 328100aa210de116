// Stencils of points against a rigid shape.
#pragma once

#include "constraints/contact/friction/frictional_pool.h"
#include "constraints/contact/rigid/rigid_geometry.h"

namespace isochor {

class ContactPool final : public FrictionalPool<RigidGeometry>,
                          public BarrierStencils,
                          public MovingStencils {
 public:
  ContactPool(std::string name, RigidGeometry geometry, FrictionLaw friction, bool coupled)
      : FrictionalPool(std::move(name), std::move(geometry), {friction}, coupled) {}

  bool sees_rigid_motion() const override { return !geometry().shape_points(); }
  StencilFacets facets() const override {
    StencilFacets f = friction_facets();
    if (!geometry().shape_points()) f.moving = this;
    if (geometry().shape().shape != ObstacleShape::plane) f.barrier = this;
    return f;
  }
  bool moves(double t0, double t1) const override { return geometry().moves(t0, t1); }
  // contact_intrusion.cpp
  Index passing(const StencilIncrement& increment, std::span<const Vec3> x,
                std::span<Vec3> stopped) const override;
  double intrusion(double t0, double t1, std::span<const Vec3> from, std::span<const Vec3> x) const override;

 private:
  bool meets_elsewhere(Index s, const Vec3& y0, const Vec3& y1, Vec3& met) const;
};

extern template class FrictionalPool<RigidGeometry>;  // rigid_touch.cpp

}  // namespace isochor
