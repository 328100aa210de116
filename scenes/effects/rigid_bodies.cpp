#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

void describe(Visitor& io, RigidBodyDef& r) {
  const RigidBodyDef d;
  io.about("rigid_body",
           "Moves by the forces on it; dynamics only. It touches what contacts that name it say, see "
           "[contact](effects/contact.md).");
  io.required_text(name_key, r.name);
  io.optional_object(Key("shape", "", "any but a plane, where it is at rest").must(), r.shape, true);
  io.number(Key("density", "kg/m^3", "").above(0), r.density, d.density);
}

}  // namespace keys

namespace {

Result<EffectPtr> make(const RigidBodyDef& body, const std::string& where, EffectAdder& adder) {
  RigidBodyDef def = body;
  if (auto loaded = adder.solids().load(def.shape); !loaded)
    return Error{where + ".shape: " + loaded.error()};
  adder.rigid_shapes.push_back(def.shape);
  return rigid_body(std::move(def));
}

}  // namespace

constinit const EffectKind rigid_bodies_kind =
    effect_kind<&SceneDef::rigid_bodies, make>("rigid_bodies", "rigid body", EffectPhase::contact);

}  // namespace isochor
