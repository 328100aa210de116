// Stencils of edges on moving surfaces against edges that they cross.
#pragma once

#include "constraints/contact/friction/frictional_pool.h"
#include "constraints/contact/surface/edge_geometry.h"

namespace isochor {

class EdgeContactPool final : public FrictionalPool<EdgeGeometry>, public RenewedStencils {
 public:
  using Setup = EdgeGeometry::Setup;
  // `partner`: by edge the one that it meets, or -1.
  EdgeContactPool(const std::shared_ptr<const Setup>& setup, std::vector<Index> partner)
      : FrictionalPool(setup->name, EdgeGeometry(setup, std::move(partner)), {setup->friction, 1},
                       setup->coupled) {}

  const Setup& setup() const { return *geometry().setup(); }
  // By edge: one more than the partner, then what friction keeps.
  void accept(const StencilRequest& request, std::span<double> memory) const override;
  StencilFacets facets() const override { return with_pairs(friction_facets(), *this, *this); }
  Renewal renewed(const RenewalRequest& request) const override;
  Result<std::shared_ptr<const StencilPool>> restored(std::span<const double> memory) const override;

 private:
  double reach() const { return setup().offset + 0.75 * setup().edges->size(); }
};

extern template class FrictionalPool<EdgeGeometry>;  // edge_touch.cpp

}  // namespace isochor
