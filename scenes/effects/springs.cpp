#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

void describe(Visitor& io, SpringDef& s) {
  const SpringDef d;
  io.about("spring",
           "Between two points of bodies or to a fixed place, see [springs](effects/loads.md#springs).");
  io.required_text(name_key, s.name);
  io.body(body_key, s.body);
  io.required_vector({"from", "m", "in or on the body at rest"}, s.from);
  io.optional_body(Key("to_body", "", "the body that `to` is of").absent("a fixed place"), s.to_body);
  io.required_vector({"to", "m", "the other end"}, s.to);
  io.number(Key("stiffness", "N/m", "force over length").above(0).must(), s.stiffness, d.stiffness);
  io.optional_number(Key("length", "m", "without tension").least(0).absent("as at rest"), s.length);
  io.flag({"pulls_only", "", "slack where it is shorter"}, s.pulls_only, d.pulls_only);
  io.curve({"amount", "", "factor on the length without tension over time"}, s.amount, CurveStart::one, true);
}

}  // namespace keys

constinit const EffectKind springs_kind =
    effect_kind<&SceneDef::springs, spring>("springs", "spring", EffectPhase::lines);

}  // namespace isochor
