#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

void describe(Visitor& io, DampingDef& c) {
  const DampingDef d;
  io.about("damping", "In dynamics, on top of that of the time scheme, see [damping](effects/damping.md).");
  io.text(name_key, c.name, d.name);
  io.body(body_key, c.body);
  io.names(Key("regions", "", "that are damped").absent("all"), c.regions);
  io.number(Key("viscosity", "Pa s", "Kelvin-Voigt").least(0), c.viscosity, d.viscosity);
  io.number(Key("mass_rate", "1/s", "drag over momentum").least(0), c.mass_rate, d.mass_rate);
}

}  // namespace keys

constinit const EffectKind damping_kind =
    effect_kind<&SceneDef::damping, damping>("damping", "damping", EffectPhase::loads);

}  // namespace isochor
