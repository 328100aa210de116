// Scenes as JSON texts and files. Nothing of the JSON library is seen from here.
#pragma once

#include <string>
#include <vector>

#include "scenes/scene.h"

namespace isochor {

// "path=value": a place in the scene file such as bodies[0].materials[0].poisson or, by name,
// cavities.chamber.amount, and a JSON value (what is none is taken as a text).
using Overrides = std::vector<std::string>;

Result<SceneDef> read_scene_file(const std::string& path, const Overrides& overrides = {});
// `source` names the text in messages; `folder` is where relative mesh paths start.
Result<SceneDef> parse_scene(const std::string& text, const std::string& source, const std::string& folder,
                             const Overrides& overrides = {});
Result<SceneDef> override_scene(const SceneDef& scene, const Overrides& overrides);

// The scene as the text of a scene file. Mesh paths stay as they are.
std::string to_json(const SceneDef& scene);

// What of a scene, kept as to_json() gave it, is another in this one: "analysis.steps was 10 and is 20".
// Titles, and when checkpoints are made, do not count. Empty: nothing.
std::string scene_difference(const std::string& kept, const SceneDef& scene);

// Every key that there is, with its kind: "bodies[].materials[].young: number".
std::vector<std::string> scene_file_keys();
// The same for people, with unit, default and meaning: a line a key, and tables of Markdown.
std::string scene_key_lines();
std::string scene_key_tables();
// The JSON Schema of scene files.
std::string scene_schema();

}  // namespace isochor
