#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

void describe(Visitor& io, TractionDef& t) {
  const TractionDef d;
  io.about("traction", "A load on faces that keeps its direction, see [loads](effects/loads.md).");
  io.required_text(name_key, t.name);
  io.body(body_key, t.body);
  io.required_text({"surface", "", "one of the mesh or of the body"}, t.surface);
  io.vector({"traction", "Pa", "force per area at rest"}, t.traction, d.traction);
  io.vector({"total_force", "N", "instead of `traction`"}, t.total_force, d.total_force);
  io.text({"field", "", "of the mesh at nodes with one component: factors on the traction"}, t.field,
          d.field);
  io.text(profile_key, t.profile, d.profile);
  io.flag({"current_area", "", "per area as it is, not at rest"}, t.current_area, d.current_area);
  io.flag({"lagged", "", "of current_area: hold the area within an iteration, for symmetric systems"},
          t.lagged, d.lagged);
  io.curve({"amount", "", "scales it over time"}, t.amount, CurveStart::zero, true);
}

}  // namespace keys

constinit const EffectKind tractions_kind =
    effect_kind<&SceneDef::tractions, traction>("tractions", "traction", EffectPhase::loads);

}  // namespace isochor
