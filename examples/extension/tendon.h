// An effect of one's own, as docs/adding-a-constraint.md makes it.
#pragma once

#include <isochor/effects.h>

namespace isochor {

// An elastic tendon through nodes of a body: those nearest to the given points, in this order.
struct TendonDef {
  std::string name = "tendon";
  BodyId body{};
  std::vector<Vec3> points;           // rest positions [m], at least two
  double stiffness = 0;               // [N/m], of the whole tendon; 0: inextensible
  Curve amount = Curve::constant(0);  // length pulled in [m]
};
EffectPtr tendon(TendonDef def);

}  // namespace isochor
