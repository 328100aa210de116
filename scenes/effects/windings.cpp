#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

void describe(Visitor& io, WindingDef& w) {
  const WindingDef d;
  io.about("winding", "Threads bonded to the body along paths, see [cable](effects/cable.md).");
  io.required_text(name_key, w.name);
  io.body(body_key, w.body);
  io.paths(Key("paths", "m", "`[[point, point, ...], ...]` in or on the body at rest").must(), w.paths);
  io.number(Key("stiffness", "N", "tension over strain, E A; 0: inextensible").least(0), w.stiffness,
            d.stiffness);
  io.number(Key("slack", "", "strain that is free").least(0), w.slack, d.slack);
  io.flag({"pulls_only", "", "false: it resists shortening too"}, w.pulls_only, d.pulls_only);
}

}  // namespace keys

constinit const EffectKind windings_kind =
    effect_kind<&SceneDef::windings, winding>("windings", "winding", EffectPhase::lines);

}  // namespace isochor
