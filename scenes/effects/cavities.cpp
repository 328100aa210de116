#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

ISOCHOR_WORDS(CavityControl, ISOCHOR_WORD(CavityControl, pressure), ISOCHOR_WORD(CavityControl, volume),
              ISOCHOR_WORD(CavityControl, volume_ratio), ISOCHOR_WORD(CavityControl, gas),
              ISOCHOR_WORD(CavityControl, liquid));

namespace {

CurveStart start_of(CavityControl control) {
  if (control == CavityControl::pressure) return CurveStart::zero;
  return control == CavityControl::volume ? CurveStart::constant : CurveStart::one;
}

}  // namespace

void describe(Visitor& io, CavityDef& c) {
  const CavityDef d;
  io.about("cavity", "A chamber, see [cavity](effects/cavity.md).");
  io.required_text(name_key, c.name);
  io.body(body_key, c.body);
  io.names(Key("surfaces", "", "faces that bound it").must(), c.surfaces);
  io.word({"control", "", "what is given"}, c.control, d.control);
  io.required_curve({"amount", "Pa, m^3 or 1",
                     "gauge pressure, volume, volume over rest volume; gas or liquid supplied so far over "
                     "what fills the chamber at rest"},
                    c.amount, start_of(c.control));
  io.number(Key("polytropic", "", "exponent of a gas: p V^n; 1: isothermal").least(1), c.polytropic,
            d.polytropic);
  io.number(Key("ambient", "Pa", "absolute pressure outside").above(0), c.ambient, d.ambient);
  io.number(Key("density", "kg/m^3", "of a liquid that feels the gravity of the scene").least(0), c.density,
            d.density);
  io.flag({"cap_free_openings", "", "close openings that no support holds, too"}, c.cap_free_openings,
          d.cap_free_openings);
}

}  // namespace keys

namespace {

Result<EffectPtr> make(const CavityDef& chamber, const std::string&, EffectAdder& adder) {
  CavityDef def = chamber;
  // The liquid feels the gravity of the scene.
  if (def.density > 0 && def.gravity == Vec3{}) {
    def.gravity = adder.scene().analysis.options.gravity;
    def.gravity_curve = adder.scene().analysis.options.gravity_curve;
  }
  return cavity(std::move(def));
}

}  // namespace

constinit const EffectKind cavities_kind =
    effect_kind<&SceneDef::cavities, make>("cavities", "cavity", EffectPhase::chambers);

}  // namespace isochor
