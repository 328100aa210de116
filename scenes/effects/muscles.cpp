#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

ISOCHOR_WORDS(MuscleTension, ISOCHOR_WORD(MuscleTension, nominal), ISOCHOR_WORD(MuscleTension, current));

void describe(Visitor& io, MuscleDef& m) {
  const MuscleDef d;
  io.about("muscle", "Active stress along fibers, see [muscle](effects/active.md#muscles).");
  io.required_text(name_key, m.name);
  io.body(body_key, m.body);
  io.names(Key("regions", "", "that pull").absent("all"), m.regions);
  io.vector({"direction", "", "of the fibers at rest"}, m.direction, d.direction);
  io.points({"directions", "", "instead: one a cell of the body's mesh"}, m.directions);
  io.text({"field", "", "instead: of the mesh in cells, with three components"}, m.field, d.field);
  io.required_curve({"amount", "Pa", "the active stress; positive pulls"}, m.amount, CurveStart::zero);
  io.word({"tension", "", "the stress is per area at rest, or as it is"}, m.tension, d.tension);
  io.number(Key("optimal_stretch", "", "of the fibers where the muscle is strongest").above(0),
            m.optimal_stretch, d.optimal_stretch);
  io.number(Key("width", "", "how far from there it pulls; 0: everywhere alike").least(0), m.width, d.width);
}

}  // namespace keys

constinit const EffectKind muscles_kind =
    effect_kind<&SceneDef::muscles, muscle>("muscles", "muscle", EffectPhase::loads);

}  // namespace isochor
