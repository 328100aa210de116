#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

void describe(Visitor& io, MembraneDef& m) {
  const MembraneDef d;
  io.about("membrane", "A neo-Hookean membrane in plane stress, see [epidermis](effects/epidermis.md).");
  io.text(name_key, m.name, d.name);
  io.body(body_key, m.body);
  io.names(surfaces_key.must(), m.surfaces);
  io.number(Key("young", "Pa", "of the membrane").above(0).must(), m.young, d.young);
  io.number(Key("poisson", "", "of the membrane").least(0).most(0.5), m.poisson, d.poisson);
  io.number(Key("thickness", "m", "of the membrane").above(0).must(), m.thickness, d.thickness);
  describe_prestretch(io, m);
}

}  // namespace keys

constinit const EffectKind membranes_kind =
    effect_kind<&SceneDef::membranes, membrane>("membranes", "membrane", EffectPhase::loads);

}  // namespace isochor
