// A scene file as a whole.
#include "scenes/effects/kind.h"
#include "scenes/keys/parts.h"

namespace isochor::keys {

void describe(Visitor& io, ScheduleDef& s) {
  const ScheduleDef d;
  io.about("schedule",
           "Effects that are there between two times, see [effects that begin and "
           "end](#effects-that-begin-and-end).");
  io.names(Key("effects", "", "of any kind but `volumes`").must(), s.effects);
  io.number(Key("from", "s", "the end of a step; statics: load factor").least(0), s.from, d.from);
  io.optional_number(Key("to", "s", "likewise, later").above(0).absent("the end of the run"), s.to);
}

void describe(Visitor& io, SceneDef& s) {
  const SceneDef d;
  io.about("scene",
           "Bodies, constraints and loads, how to advance them, what to watch. Units are SI: m, kg, s, N, "
           "Pa. Relative paths start at the file's folder.");
  io.note({"$schema", "", "for editors; `scenes/scene.schema.json` lets them check while you type"});
  io.text(Key("name", "", "names the outputs").absent("the file's name"), s.name, "");
  io.text({"title", "", "text"}, s.title, d.title);
  io.text({"description", "", "text"}, s.description, d.description);
  io.list(Key("bodies", "", "at least one").must(), s.bodies);
  io.bodies_known(s.bodies);
  io.settings({"analysis", "", "how to advance"}, s.analysis);
  io.analysis_known(s.analysis);
  for (const EffectKind* kind : effect_kinds) kind->keys(*kind, io, s);
  io.list({"schedule", "", "when effects begin and end; what it does not name is always there"}, s.schedule);
  WorldOptions& o = s.analysis.options;
  io.vector({"gravity", "m/s^2", "of everything that has mass"}, o.gravity, d.analysis.options.gravity);
  io.curve({"gravity_amount", "", "scales gravity over time"}, o.gravity_curve, CurveStart::zero,
           !(o.gravity == Vec3{}));
  io.list({"probes", "", "points to follow"}, s.probes);
  io.list({"orientations", "", "faces and sets of nodes to follow"}, s.orientations);
  io.settings({"outputs", "", "what is written"}, s.outputs);
  io.list({"metrics", "", "numbers to report and to compare"}, s.metrics);
}

}  // namespace isochor::keys
