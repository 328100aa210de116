#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

void describe(Visitor& io, TieDef& t) {
  const TieDef d;
  io.about("tie",
           "Holds nodes of one body to the points of another that they lie on at rest, see "
           "[tie](effects/tie.md).");
  io.required_text(name_key, t.name);
  io.object({"where", "", "nodes that are attached"}, t.where);
  io.body(Key("to", "", "the body that holds them").must(), t.to);
  io.number(Key("stiffness", "N/m", "of all springs together; 0: hard").least(0), t.stiffness, d.stiffness);
}

}  // namespace keys

constinit const EffectKind ties_kind = effect_kind<&SceneDef::ties, tie>("ties", "tie", EffectPhase::ties);

}  // namespace isochor
