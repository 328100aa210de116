// The rows of surface contact between edges that cross.
#pragma once

#include "constraints/contact/contact_effect.h"
#include "constraints/contact/surface/edge_contact_pool.h"
#include "isochor/effects/contact.h"

namespace isochor {

class EdgeContact {
 public:
  // Of the surfaces of a surface contact whose layer is given. Adds nothing where no edge bulges. Fails where
  // edges are past each other at the start and that is not to be resolved.
  static Result<EdgeContact> build(Builder& builder, const SurfaceContactDef& def,
                                   const ContactSurface& surface, const ContactLayer& layer);

  // Of the first side; no area, pressure or depth.
  ContactTotals totals(const GaugeContext& context) const;
  void pressing_points(const GaugeContext& context, std::vector<PressingPoint>& out) const;

 private:
  std::shared_ptr<const ContactRows> rows_;  // null: there are no edges
  Index row_pool_ = -1;
};

}  // namespace isochor
