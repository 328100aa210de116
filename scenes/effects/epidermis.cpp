#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

void describe(Visitor& io, EpidermisDef& e) {
  const EpidermisDef d;
  io.about("epidermis",
           "A layer that resists changes of area, see [epidermis](effects/epidermis.md): `young`, `poisson` "
           "and `thickness`, or `stiffness`.");
  io.text(name_key, e.name, d.name);
  io.body(body_key, e.body);
  io.names(surfaces_key.must(), e.surfaces);
  io.number(Key("young", "Pa", "of the layer").above(0).absent("by `stiffness`"), e.young, d.young);
  io.number(Key("poisson", "", "of the layer").above(0).most(0.5).absent("by `stiffness`"), e.poisson,
            d.poisson);
  io.number(Key("thickness", "m", "of the layer").above(0).absent("by `stiffness`"), e.thickness,
            d.thickness);
  io.number_or_inf(
      Key("stiffness", "N/m", "instead of these three; `\"inf\"` keeps every area").absent("by the three"),
      e.stiffness, d.stiffness);
  io.number(Key("gamma", "", "how soon it stiffens").least(0), e.gamma, d.gamma);
}

}  // namespace keys

constinit const EffectKind epidermis_kind =
    effect_kind<&SceneDef::epidermis, epidermis>("epidermis", "epidermis", EffectPhase::loads);

}  // namespace isochor
