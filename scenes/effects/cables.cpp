#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

ISOCHOR_WORDS(CableControl, ISOCHOR_WORD(CableControl, tension), ISOCHOR_WORD(CableControl, length),
              ISOCHOR_WORD(CableControl, length_ratio));

namespace {

CurveStart start_of(CableControl control) {
  if (control == CableControl::tension) return CurveStart::zero;
  return control == CableControl::length ? CurveStart::constant : CurveStart::one;
}

}  // namespace

void describe(Visitor& io, CableDef& c) {
  const CableDef d;
  io.about(
      "cable",
      "Pulls, never pushes, and slides through its points without friction, see [cable](effects/cable.md).");
  io.required_text(name_key, c.name);
  io.body(body_key, c.body);
  io.points(Key("points", "m", "in or on the body at rest, in order").must(), c.points);
  io.optional_vector(Key("from", "m", "a fixed place that it comes from").absent("none"), c.from);
  io.optional_vector(Key("to", "m", "a fixed place that it goes to").absent("none"), c.to);
  io.word({"control", "", "what is given"}, c.control, d.control);
  io.required_curve({"amount", "N, m or 1", "tension, length, or length over rest length"}, c.amount,
                    start_of(c.control));
  io.number(Key("stiffness", "N/m", "of the whole cable when its length is given; 0: inextensible").least(0),
            c.stiffness, d.stiffness);
}

}  // namespace keys

constinit const EffectKind cables_kind =
    effect_kind<&SceneDef::cables, cable>("cables", "cable", EffectPhase::lines);

}  // namespace isochor
