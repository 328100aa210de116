#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

void describe(Visitor& io, SurfaceContactDef& c) {
  const SurfaceContactDef d;
  io.about("surface_contact",
           "Surfaces of soft bodies against each other, or of one body against itself, see "
           "[contact](effects/contact.md).");
  io.required_text(name_key, c.name);
  io.body(body_key, c.body);
  io.names(surfaces_key.absent("the whole boundary"), c.surfaces);
  io.optional_body(Key("against", "", "the other body").absent("the surfaces touch each other"), c.against);
  io.names(Key("against_surfaces", "", "of the other body").absent("its whole boundary"), c.against_surfaces);
  io.optional_number(Key("compliance", "m/Pa", "depth over pressure")
                         .above(0)
                         .absent("that of a layer two percent of a face thick"),
                     c.compliance);
  io.number(Key("thickness", "m", "distance that the surfaces keep").least(0), c.thickness, d.thickness);
  describe_friction(io, c, d);
  describe_overlap(io, c, d);
}

}  // namespace keys

constinit const EffectKind surface_contacts_kind = effect_kind<&SceneDef::surface_contacts, surface_contact>(
    "surface_contacts", "surface contact", EffectPhase::contact);

}  // namespace isochor
