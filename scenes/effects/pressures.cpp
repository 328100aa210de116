#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

void describe(Visitor& io, PressureDef& p) {
  const PressureDef d;
  io.about("pressure",
           "Pressure that follows any faces of the boundary, open or closed, see "
           "[pressure](effects/pressure.md).");
  io.required_text(name_key, p.name);
  io.body(body_key, p.body);
  io.names(surfaces_key.must(), p.surfaces);
  io.required_curve({"amount", "Pa", "positive pushes inward"}, p.amount, CurveStart::zero);
  io.text({"field", "", "of the mesh at nodes with one component: factors on the pressure"}, p.field,
          d.field);
  io.text(profile_key, p.profile, d.profile);
  io.flag(
      {"lagged", "", "hold what a free rim adds within an iteration: symmetric systems, linear convergence"},
      p.lagged, d.lagged);
}

}  // namespace keys

constinit const EffectKind pressures_kind =
    effect_kind<&SceneDef::pressures, pressure>("pressures", "pressure", EffectPhase::loads);

}  // namespace isochor
