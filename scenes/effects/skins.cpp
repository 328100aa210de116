#include "scenes/body_parts.h"
#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

void describe(Visitor& io, SkinDef::Bone& b) {
  const SkinDef::Bone d;
  io.about("skin_bone", "A bone of a skin: how it moves, and which nodes follow how much.");
  io.text({"motion", "", "a file of poses, as for bones of supports"}, b.track.file, d.track.file);
  io.list({"keyframes", "", "instead of a file"}, b.track.keys);
  io.numbers({"weights", "", "one a node of the body's mesh"}, b.weights);
  io.text({"field", "", "instead: of the mesh at nodes, with one component"}, b.field, d.field);
}

void describe(Visitor& io, SkinDef& s) {
  io.about("skin", "Nodes that follow several bones by weights, see [skins](effects/dirichlet.md#skins).");
  io.required_text(name_key, s.name);
  io.object({"where", "", "nodes that follow"}, s.where);
  io.list(Key("bones", "", "that they follow").must(), s.bones);
}

}  // namespace keys

namespace {

Result<EffectPtr> make(const SkinDef& said, const std::string& where, EffectAdder& adder) {
  SkinDef def = said;
  for (std::size_t b = 0; b < def.bones.size(); ++b) {
    PoseTrack& track = def.bones[b].track;
    if (!track.keys.empty() || track.file.empty()) continue;
    auto read = read_poses(path_in(adder.scene().folder, track.file));
    if (!read) return Error{place(where + ".bones", b) + ".motion: " + read.error()};
    track = std::move(read).value();
  }
  return skin(std::move(def));
}

}  // namespace

constinit const EffectKind skins_kind =
    effect_kind<&SceneDef::skins, make>("skins", "skin", EffectPhase::supports);

}  // namespace isochor
