#include "scenes/body_parts.h"
#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

ISOCHOR_WORDS(SupportTreatment, ISOCHOR_WORD(SupportTreatment, eliminated),
              ISOCHOR_WORD(SupportTreatment, multiplier), ISOCHOR_WORD(SupportTreatment, stiffness));

namespace {
struct Rotation {
  DirichletDef& def;
};
}  // namespace

void describe(Visitor& io, Rotation& r) {
  const DirichletDef d;
  io.about("rotation", "About an axis.");
  io.vector({"point", "m", "on the axis"}, r.def.axis_point, d.axis_point);
  io.required_vector({"axis", "", "its direction"}, r.def.axis);
  io.angle({"angle", "rad", "at amount 1"}, {"angle_deg", "deg", "the same, instead"}, r.def.angle);
}

void describe(Visitor& io, DirichletDef& s) {
  const DirichletDef d;
  io.about("dirichlet",
           "Prescribed positions, see [dirichlet](effects/dirichlet.md). Without displacement, rotation and "
           "bone the nodes are held.");
  io.required_text(name_key, s.name);
  io.object({"where", "", "what is held"}, s.where);
  io.directions(Key("directions", "", "letters (`\"xz\"`) or vectors").absent("all"), s.directions);
  io.vector({"displacement", "m", "at amount 1"}, s.displacement, d.displacement);
  Rotation rotation{s};
  io.optional_object({"rotation", "", "at amount 1"}, rotation, s.angle != 0);
  io.text({"bone", "",
           "instead: a file of poses that the nodes follow, lines t, x, y, z, qw, qx, qy, qz; the first is "
           "the pose at rest"},
          s.bone.file, d.bone.file);
  io.word({"treatment", "", "how they enter the system: no unknowns, hard rows, or springs"}, s.treatment,
          d.treatment);
  io.number(Key("stiffness", "N/m", "of treatment `stiffness`: of all springs together").least(0),
            s.stiffness, d.stiffness);
  io.points({"points", "m", "in the body, that are held too; not with treatment `eliminated`"}, s.points);
  const bool moves = s.angle != 0 || !(s.displacement == Vec3{});
  io.curve({"amount", "", "scales displacement and rotation over time"}, s.amount, CurveStart::zero, moves);
}

}  // namespace keys

namespace {

Result<EffectPtr> make(const DirichletDef& support, const std::string& where, EffectAdder& adder) {
  DirichletDef def = support;
  if (def.bone.keys.empty() && !def.bone.file.empty()) {
    auto track = read_poses(path_in(adder.scene().folder, def.bone.file));
    if (!track) return Error{where + ".bone: " + track.error()};
    def.bone = std::move(track).value();
  }
  return dirichlet(std::move(def));
}

}  // namespace

constinit const EffectKind dirichlet_kind =
    effect_kind<&SceneDef::dirichlet, make>("dirichlet", "support", EffectPhase::supports);

}  // namespace isochor
