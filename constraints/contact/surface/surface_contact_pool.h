// Stencils of points on moving surfaces against the triangles that are close to them.
#pragma once

#include "constraints/contact/friction/frictional_pool.h"
#include "constraints/contact/surface/patch_geometry.h"

namespace isochor {

class SurfaceContactPool final : public FrictionalPool<PatchGeometry>, public RenewedStencils {
 public:
  using Setup = PatchGeometry::Setup;
  // `center` as of the geometry.
  SurfaceContactPool(const std::shared_ptr<const Setup>& setup, std::vector<Index> center)
      : FrictionalPool(setup->name, PatchGeometry(setup, std::move(center)), {setup->friction, 1},
                       setup->coupled) {}

  const Setup& setup() const { return *geometry().setup(); }
  // By point: one more than the center, then what friction keeps.
  void accept(const StencilRequest& request, std::span<double> memory) const override;
  StencilFacets facets() const override { return with_pairs(friction_facets(), *this, *this); }
  Renewal renewed(const RenewalRequest& request) const override;
  Result<std::shared_ptr<const StencilPool>> restored(std::span<const double> memory) const override;

 private:
  // The nearest place of a patch around a triangle.
  PatchPoint seen_from(Index s, Index center, std::span<const Vec3> x) const;
  bool reaches_out(const PatchPoint& near, Index s, Index center, std::span<const Vec3> x) const;
  double reach() const { return setup().offset + 0.75 * setup().surface->size(); }
};

extern template class FrictionalPool<PatchGeometry>;  // patch_touch.cpp

}  // namespace isochor
