#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

void describe(Visitor& io, ValveDef& v) {
  const ValveDef d;
  io.about("valve", "Between two chambers of gas or of liquid, or a leak, see [cavity](effects/cavity.md).");
  io.required_text(name_key, v.name);
  io.required_text({"from", "", "a cavity of control `gas` or `liquid`"}, v.from);
  io.text(Key("to", "", "another one").absent("outside, a leak"), v.to, d.to);
  io.number(Key("conductance", "m^3/(s Pa)", "flow over difference of pressures").above(0).must(),
            v.conductance, d.conductance);
  io.curve({"amount", "", "opening; 0: shut"}, v.amount, CurveStart::constant, true);
}

}  // namespace keys

constinit const EffectKind valves_kind =
    effect_kind<&SceneDef::valves, valve>("valves", "valve", EffectPhase::valves);

}  // namespace isochor
