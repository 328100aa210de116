#include "scenes/body_parts.h"
#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

void describe(Visitor& io, DrivenDef& d) {
  const DrivenDef standard;
  io.about("driven", "Nodes that follow data, see [data](effects/dirichlet.md#nodes-that-follow-data).");
  io.required_text(name_key, d.name);
  io.body(body_key, d.body);
  io.text({"file", "", "of lines t, node, x, y, z: frame after frame with the same nodes"}, d.file,
          standard.file);
  io.indices({"nodes", "", "instead of a file: of the body's mesh, counted from 0"}, d.nodes);
  io.numbers({"times", "s", "of the frames; statics: load factor"}, d.times);
  io.paths({"positions", "m", "`[[point, point, ...], ...]`: a list a frame, a point a node"}, d.positions);
}

}  // namespace keys

namespace {

Result<EffectPtr> make(const DrivenDef& said, const std::string& where, EffectAdder& adder) {
  DrivenDef def = said;
  if (!def.file.empty()) {
    if (!def.nodes.empty() || !def.times.empty() || !def.positions.empty())
      return Error{where + ": a file and nodes, times or positions are given; give one of them"};
    auto read = read_driven(path_in(adder.scene().folder, def.file));
    if (!read) return Error{where + ".file: " + read.error()};
    read.value().name = def.name;
    read.value().body = def.body;
    def = std::move(read).value();
  }
  return driven(std::move(def));
}

}  // namespace

constinit const EffectKind driven_kind =
    effect_kind<&SceneDef::driven, make>("driven", "driven nodes", EffectPhase::supports);

}  // namespace isochor
