#include "scenes/body_parts.h"
#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

void describe(Visitor& io, ContactDef& c) {
  const ContactDef d;
  io.about(
      "contact",
      "Nodes of a surface do not enter an obstacle; it does not pull, see [contact](effects/contact.md).");
  io.required_text(name_key, c.name);
  io.body(body_key, c.body);
  io.names(surfaces_key.absent("the whole boundary"), c.surfaces);
  io.text(Key("rigid", "", "the rigid body that touches, instead of `body`").absent("none"), c.rigid,
          d.rigid);
  io.text(Key("against", "", "the rigid body that is touched, instead of `obstacle`").absent("none"),
          c.against, d.against);
  io.optional_object(Key("obstacle", "", "what is touched").absent("the floor z = 0"), c.obstacle,
                     c.against.empty());
  io.number(Key("compliance", "m/Pa", "depth over pressure; 0: hard").least(0), c.compliance, d.compliance);
  describe_friction(io, c, d);
  io.number(Key("restitution", "", "Newton's coefficient; hard contact in dynamics").least(0).most(1),
            c.restitution, d.restitution);
  io.number(Key("restitution_speed", "m/s", "what closes more slowly does not bounce").least(0),
            c.restitution_speed, d.restitution_speed);
  describe_overlap(io, c, d);
}

}  // namespace keys

namespace {

Result<EffectPtr> make(const ContactDef& touch, const std::string& where, EffectAdder& adder) {
  ContactDef def = touch;
  PoseTrack& motion = def.obstacle.motion;
  if (motion.keys.empty() && !motion.file.empty()) {
    auto track = read_poses(path_in(adder.scene().folder, motion.file));
    if (!track) return Error{where + ".obstacle.motion: " + track.error()};
    motion = std::move(track).value();
  }
  if (auto loaded = adder.solids().load(def.obstacle); !loaded)
    return Error{where + ".obstacle: " + loaded.error()};
  adder.obstacles.push_back(def.obstacle);
  return contact(std::move(def));
}

}  // namespace

constinit const EffectKind contacts_kind =
    effect_kind<&SceneDef::contacts, make>("contacts", "contact", EffectPhase::contact);

}  // namespace isochor
