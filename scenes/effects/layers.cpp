#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

void describe(Visitor& io, StrainLimitDef& l) {
  const StrainLimitDef d;
  io.about("layer", "Fabric on a surface that resists stretching, see [cable](effects/cable.md).");
  io.required_text(name_key, l.name);
  io.body(body_key, l.body);
  io.names(surfaces_key.must(), l.surfaces);
  io.number(Key("stiffness", "N/m", "Young's modulus times thickness").above(0).must(), l.stiffness,
            d.stiffness);
  io.number(Key("slack", "", "strain that is free").least(0), l.slack, d.slack);
  io.flag({"pulls_only", "", "false: it resists shortening too"}, l.pulls_only, d.pulls_only);
}

}  // namespace keys

constinit const EffectKind layers_kind =
    effect_kind<&SceneDef::layers, strain_limit>("layers", "layer", EffectPhase::lines);

}  // namespace isochor
