#include "scenes/scene_file.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "scenes/json/overrides.h"
#include "scenes/json/parse.h"
#include "scenes/json/reader.h"
#include "scenes/json/writer.h"
#include "scenes/keys/parts.h"

namespace isochor {

using scene_json::Json;

namespace {

constexpr std::uintmax_t kMostBytes = 64u << 20;

Result<SceneDef> from_json(const Json& json, const std::string& source, const std::string& folder) {
  SceneDef scene;
  scene_json::ReadContext context;
  try {
    scene_json::Reader reader(json, "", context);
    keys::describe(reader, scene);
    reader.finish();
  } catch (const std::exception& e) {
    return Error{source + ": " + scene_json::plain(e.what())};
  }
  if (!context.error.empty()) return Error{source + ": " + context.error};
  scene.folder = folder;
  if (auto r = check_scene(scene); !r) return Error{source + ": " + r.error()};
  return scene;
}

Result<void> apply(Json& json, const Overrides& overrides) {
  for (const std::string& o : overrides) {
    if (auto r = scene_json::apply_override(json, o); !r) return r;
  }
  return {};
}

Json json_of(const SceneDef& scene) {
  Json json;
  SceneDef copy = scene;  // descriptions take what they may fill
  scene_json::Writer writer(json, copy);
  keys::describe(writer, copy);
  return json;
}

std::string described(const std::string& source, const Overrides& overrides) {
  std::string text = source;
  for (const auto& o : overrides) text += " --set " + o;
  return text;
}

}  // namespace

Result<SceneDef> parse_scene(const std::string& text, const std::string& source, const std::string& folder,
                             const Overrides& overrides) {
  if (text.find_first_not_of(" \t\r\n") == std::string::npos)
    return Error{source + ": the file is empty; a scene needs at least \"bodies\""};
  auto json = scene_json::parse_object(text, source);
  if (!json) return json.failure();
  if (auto r = apply(json.value(), overrides); !r) return Error{source + ": " + r.error()};
  return from_json(json.value(), described(source, overrides), folder);
}

Result<SceneDef> read_scene_file(const std::string& path, const Overrides& overrides) {
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  if (!std::filesystem::exists(status)) return Error{path + ": there is no such file"};
  if (std::filesystem::is_directory(status)) return Error{path + ": this is a folder, not a scene file"};
  std::ifstream in(path, std::ios::binary);
  if (!in) return Error{path + ": cannot be read; check its permissions"};
  std::string text;
  char block[1 << 16];
  while (in.read(block, sizeof block) || in.gcount() > 0) {
    text.append(block, static_cast<std::size_t>(in.gcount()));
    if (text.size() > kMostBytes) return Error{path + ": larger than 64 MiB; this is no scene file"};
  }
  const auto stem = std::filesystem::path(path).stem().string();
  auto scene = parse_scene(text, path, std::filesystem::path(path).parent_path().string(), overrides);
  if (scene && scene.value().name == SceneDef{}.name && !stem.empty()) scene.value().name = stem;
  return scene;
}

Result<SceneDef> override_scene(const SceneDef& scene, const Overrides& overrides) {
  if (overrides.empty()) return scene;
  Json json = json_of(scene);
  if (auto r = apply(json, overrides); !r) return Error{"scene " + scene.name + ": " + r.error()};
  return from_json(json, described("scene " + scene.name, overrides), scene.folder);
}

std::string to_json(const SceneDef& scene) {
  return scene_json::text_of(json_of(scene)) + "\n";
}

namespace {

// "/bodies/0/mesh" as "bodies[0].mesh".
std::string dotted(const std::string& pointer) {
  std::string text;
  std::size_t at = 1;
  while (at <= pointer.size()) {
    const std::size_t end = std::min(pointer.find('/', at), pointer.size());
    const std::string key = pointer.substr(at, end - at);
    const bool number = !key.empty() && key.find_first_not_of("0123456789") == std::string::npos;
    text += number ? "[" + key + "]" : (text.empty() ? "" : ".") + key;
    at = end + 1;
  }
  return text;
}

std::string shortened(const Json& json) {
  const std::string text = scene_json::inline_text(json);
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

}  // namespace

std::string scene_difference(const std::string& kept, const SceneDef& scene) {
  const Json before = Json::parse(kept, nullptr, false);
  if (before.is_discarded()) return "the scene that is kept cannot be read";
  const Json now = json_of(scene);
  for (const Json& change : Json::diff(before, now)) {
    const std::string path = change.value("path", ""), op = change.value("op", "");
    if (path == "/title" || path == "/description" || path.starts_with("/outputs/checkpoint_")) continue;
    // All of an object that holds checkpoints alone.
    if (path == "/outputs") {
      Json all = op == "remove" ? before["outputs"] : change["value"];
      all.erase("checkpoint_steps");
      all.erase("checkpoint_seconds");
      if (all.empty()) continue;
    }
    const std::string where = dotted(path);
    if (op == "remove")
      return where + " was " + shortened(before[Json::json_pointer(path)]) + " and is left out";
    if (op == "add") return where + " was left out and is " + shortened(change["value"]);
    return where + " was " + shortened(before[Json::json_pointer(path)]) + " and is " +
           shortened(change["value"]);
  }
  return {};
}

}  // namespace isochor
