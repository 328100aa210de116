// Parts of a world from the keys of scene files, one at a time: for hosts that say them as text. Keys, units
// and defaults are those of docs/scenes.md. Messages start with the kind and the key, as in "cavity.surfaces:
// ...".
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/scene.h"

namespace isochor {

// What keys of parts refer to.
struct PartContext {
  // Names that keys such as "body" may use, with their ids in the world. A key that is absent means the
  // first.
  std::vector<std::pair<std::string, BodyId>> bodies;
  // Names that other effects have. One that is given none gets that of its kind, with a number where it is
  // taken.
  std::vector<std::string> names_taken;
  AnalysisType analysis = AnalysisType::dynamics;  // how a plain number given for a curve ramps
  Vec3 gravity{};                                  // that liquids feel [m/s^2]
  Curve gravity_curve = Curve::constant(1);        // scales it
  std::string folder;                              // where relative paths start
};

// `kind` is the word for an effect or for its list in a scene file ("cavity", "cavities", "dirichlet", ...);
// `json` one object with its keys, which may be empty. Every kind makes one effect of one object. Keys that
// make none (volume rows of space "none") are refused.
Result<EffectPtr> effect_from_keys(std::string_view kind, std::string_view json, const PartContext& context);

// The keys of a selection, as in "where" of a support.
Result<Selection> selection_from_keys(std::string_view json, const PartContext& context);

// The keys of an entry of "materials".
Result<RegionMaterial> material_from_keys(std::string_view json, const std::string& folder);

// The keys of an entry of "bodies". How a body moves at the start is no part of a BodyDef and is refused. A
// `mesh` that is given stands in the place of the key "mesh", which is refused then.
Result<BodyDef> body_from_keys(std::string_view json, const std::string& folder, const Mesh* mesh = nullptr);

// The keys of "analysis" that concern a world, its scheme made; further "gravity" and "gravity_amount" as in
// a scene, "threads", and "follow" (flag: statics along paths of equilibria, for World::follow()). Unlike in
// a scene file "type" is "dynamic" when absent. Lengths and numbers of steps are refused: they are the
// host's.
Result<WorldOptions> options_from_keys(std::string_view json);

// The words for effects, as in "cavity".
std::vector<std::string> effect_kinds_known();

// What there is to say, for docs, stubs and editors:
//   {"cavity": {"list": "cavities", "what": "...", "keys": [KEY, ...]}, ...}
// with KEY {"key", "type", "unit", "meaning", "required"}, where known "default" (its value) or "absent"
// (what absence means), "words" (of type "word"), "least", "above", "most", and "keys" of types "object" and
// "list".
std::string effect_keys_json();
// The same of "material", "body" and "options".
std::string part_keys_json();

}  // namespace isochor
