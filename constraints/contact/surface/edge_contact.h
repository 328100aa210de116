// The rows of surface contact between edges that cross.
#pragma once

#include "constraints/contact/contact_rows.h"
#include "constraints/contact/surface/edge_contact_pool.h"
#include "engine/scene/builder.h"
#include "isochor/effects/contact.h"

namespace isochor {

class EdgeContact {
 public:
  // Of the surfaces of a surface contact whose layer is given. Adds nothing where no edge bulges. Fails where
  // edges are past each other at the start and that is not to be resolved.
  static Result<EdgeContact> build(Builder& builder, const SurfaceContactDef& def, const Skin& skin,
                                   const ContactLayer& layer);

  struct Totals {
    Vec3 force{};                                          // on the first side [N]
    double normal = 0, tangential = 0;                     // sums of magnitudes [N]
    double gap = std::numeric_limits<double>::infinity();  // smallest [m]
  };
  Totals totals(const GaugeContext& context) const;

 private:
  std::shared_ptr<const ContactRows> rows_;  // null: there are no edges
  Index row_pool_ = -1;
};

}  // namespace isochor
