#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

void describe(Visitor& io, PointForceDef& f) {
  io.about("force", "A dead force on nodes, see [loads](effects/loads.md).");
  io.required_text(name_key, f.name);
  io.object({"where", "", "what it acts on"}, f.where);
  io.required_vector({"force", "N", "shared equally by the nodes"}, f.force);
  io.curve({"amount", "", "scales it over time"}, f.amount, CurveStart::zero, true);
}

}  // namespace keys

constinit const EffectKind forces_kind =
    effect_kind<&SceneDef::forces, point_force>("forces", "force", EffectPhase::loads);

}  // namespace isochor
