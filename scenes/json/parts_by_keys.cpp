#include "scenes/parts_by_keys.h"

#include <algorithm>

#include "scenes/body_parts.h"
#include "scenes/check_parts.h"
#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"
#include "scenes/json/parse.h"
#include "scenes/json/reader.h"
#include "scenes/keys/catalog.h"
#include "scenes/keys/parts.h"

namespace isochor {

using scene_json::Json;
using scene_json::ReadContext;

namespace keys {

// What a host says of a world.
struct WorldKeys {
  WorldKeys() { analysis.type = AnalysisType::dynamics; }
  AnalysisDef analysis;
  bool follow = false;
};
// A body without a start.
struct BodyKeys {
  SceneBody body;
};

void describe(Visitor& io, BodyKeys& b) {
  describe_at_rest(io, b.body);
}

void describe(Visitor& io, WorldKeys& w) {
  const WorldOptions d;
  io.about("options", "Statics or dynamics, and how a world is solved.");
  describe_scheme(io, w.analysis, AnalysisType::dynamics);
  describe_solving(io, w.analysis.options);
  io.analysis_known(w.analysis);
  WorldOptions& o = w.analysis.options;
  io.vector({"gravity", "m/s^2", "of everything that has mass"}, o.gravity, d.gravity);
  io.curve({"gravity_amount", "", "scales gravity over time"}, o.gravity_curve, CurveStart::zero,
           !(o.gravity == Vec3{}));
  io.integer(Key("threads", "", "of the world; 0: all the machine has").least(0), o.threads, d.threads);
  io.flag({"follow", "", "statics along paths of equilibria"}, w.follow, false);
}

}  // namespace keys

namespace {

// An effect of the table, with the word for one of its list and the name that one has by itself.
struct EffectEntry {
  const EffectKind* kind;
  std::string word, name;
};

struct EffectTable {
  keys::Catalog catalog = keys::catalog_of_scene();
  std::vector<EffectEntry> entries;

  EffectTable() {
    for (const EffectKind* kind : effect_kinds) {
      std::string word;
      for (const keys::CatalogKey& key : catalog.objects.front().keys) {
        if (key.name == kind->key) word = key.type;
      }
      SceneDef scene;
      scene.bodies.emplace_back();
      ReadContext context;
      Json one = Json::object();
      one[kind->key] = Json::array({Json::object()});
      scene_json::Reader reader(one, "", context);
      kind->keys(*kind, reader, scene);  // what it misses is of no interest here
      entries.push_back({kind, word, kind->name(scene, 0)});
    }
  }
};

const EffectTable& table() {
  static const EffectTable made;
  return made;
}

// The place of a part is its kind; of an entry of a list it is "list[0]".
std::string placed(const std::string& message, const std::string& list, const std::string& word) {
  const std::string prefix = place(list, 0);
  return message.starts_with(prefix) ? word + message.substr(prefix.size()) : message;
}

Result<Json> parse_part(std::string_view json, const std::string& word) {
  if (json.find_first_not_of(" \t\r\n") == std::string_view::npos) return Json::object();
  return scene_json::parse_object(std::string(json), word, "what describes it");
}

template <class T>
Result<void> read_part(const Json& json, const std::string& word, ReadContext& context, T& part) {
  try {
    scene_json::Reader reader(json, word, context);
    const keys::Object object = keys::object_of(part);
    object.keys(reader, object.value);
    reader.finish();
  } catch (const std::exception& e) {
    return Error{word + ": " + scene_json::plain(e.what())};
  }
  if (!context.error.empty()) return Error{context.error};
  return {};
}

Result<const EffectEntry*> find_kind(const std::string& kind) {
  for (const EffectEntry& entry : table().entries) {
    if (kind == entry.word || kind == entry.kind->key) return &entry;
  }
  const std::vector<std::string> known = effect_kinds_known();
  std::string all;
  for (const std::string& word : known) all += (all.empty() ? "" : ", ") + word;
  return Error{scene_json::shown(Json(kind)) + " is no kind of effect" + scene_json::suggestion(kind, known) +
               "; there are " + all};
}

std::string free_name(const std::string& name, const std::vector<std::string>& taken) {
  const auto is_taken = [&](const std::string& one) {
    return std::find(taken.begin(), taken.end(), one) != taken.end();
  };
  std::string free = name;
  for (int n = 2; is_taken(free); ++n) free = name + " " + std::to_string(n);
  return free;
}

ReadContext reading_of(const PartContext& context) {
  ReadContext reading;
  reading.analysis = context.analysis;
  for (const auto& [name, id] : context.bodies) {
    reading.bodies.push_back(name);
    reading.ids.push_back(id);
  }
  return reading;
}

// A scene with this effect and nothing else.
Result<SceneDef> scene_of(const EffectEntry& entry, const Json& json, const PartContext& context) {
  ReadContext reading = reading_of(context);
  SceneDef scene;
  scene.folder = context.folder;
  scene.analysis.options.gravity = context.gravity;
  scene.analysis.options.gravity_curve = context.gravity_curve;
  Json list = Json::object();
  list[entry.kind->key] = Json::array({json});
  try {
    scene_json::Reader reader(list, "", reading);
    entry.kind->keys(*entry.kind, reader, scene);
  } catch (const std::exception& e) {
    return Error{entry.word + ": " + scene_json::plain(e.what())};
  }
  if (!reading.error.empty()) return Error{reading.error};
  if (auto r = check_name(place(entry.kind->key, 0), entry.kind->name(scene, 0)); !r) return r.failure();
  if (auto r = entry.kind->check(*entry.kind, scene); !r) return r.failure();
  return scene;
}

Json value_of(const std::string& standard) {
  return Json::parse(standard);
}

Json keys_of(const keys::Catalog& catalog, const keys::CatalogObject& object) {
  Json all = Json::array();
  for (const keys::CatalogKey& key : object.keys) {
    Json one{{"key", key.name},
             {"type", key.kind},
             {"unit", key.unit},
             {"meaning", keys::plain_text(key.meaning)},
             {"required", key.needed}};
    if (!key.standard.empty()) one["default"] = value_of(key.standard);
    if (!key.without.empty()) one["absent"] = keys::plain_text(key.without);
    if (!key.words.empty()) one["words"] = key.words;
    if (key.bounds.least) one["least"] = scene_json::plain_number(*key.bounds.least);
    if (key.bounds.above) one["above"] = scene_json::plain_number(*key.bounds.above);
    if (key.bounds.most) one["most"] = scene_json::plain_number(*key.bounds.most);
    if (!key.type.empty()) one["keys"] = keys_of(catalog, catalog.of(key.type));
    all.push_back(std::move(one));
  }
  return all;
}

template <class T>
Json part_of() {
  T part;
  const keys::Catalog catalog = keys::catalog_of(keys::object_of(part));
  const keys::CatalogObject& object = catalog.objects.front();
  return {{"what", keys::plain_text(object.what)}, {"keys", keys_of(catalog, object)}};
}

}  // namespace

Result<EffectPtr> effect_from_keys(std::string_view kind, std::string_view json, const PartContext& context) {
  auto found = find_kind(std::string(kind));
  if (!found) return found.failure();
  const EffectEntry& entry = *found.value();
  const std::string list = entry.kind->key;
  auto parsed = parse_part(json, entry.word);
  if (!parsed) return parsed.failure();
  if (!parsed.value().contains("name")) parsed.value()["name"] = free_name(entry.name, context.names_taken);
  auto scene = scene_of(entry, parsed.value(), context);
  if (!scene) return Error{placed(scene.error(), list, entry.word)};

  std::vector<EffectPtr> made;
  EffectAdder adder(scene.value(), [&](const EffectKind&, EffectPtr effect) -> Result<void> {
    made.push_back(std::move(effect));
    return {};
  });
  if (auto r = entry.kind->add(*entry.kind, adder); !r) return Error{placed(r.error(), list, entry.word)};
  if (made.size() != 1)
    return Error{entry.word + ": what its keys say makes no effect of a world; leave it out"};
  return made.front();
}

Result<Selection> selection_from_keys(std::string_view json, const PartContext& context) {
  auto parsed = parse_part(json, "where");
  if (!parsed) return parsed.failure();
  Selection selection;
  ReadContext reading = reading_of(context);
  if (auto r = read_part(parsed.value(), "where", reading, selection); !r) return r.failure();
  return selection;
}

Result<RegionMaterial> material_from_keys(std::string_view json, const std::string& folder) {
  auto parsed = parse_part(json, "material");
  if (!parsed) return parsed.failure();
  MaterialDef def;
  ReadContext context;
  if (auto r = read_part(parsed.value(), "material", context, def); !r) return r.failure();
  auto made = make_material(def, folder);
  if (!made) return Error{"material: " + made.error()};
  return RegionMaterial{def.region, std::move(made).value(), def.density};
}

Result<BodyDef> body_from_keys(std::string_view json, const std::string& folder, const Mesh* mesh) {
  auto parsed = parse_part(json, "body");
  if (!parsed) return parsed.failure();
  if (mesh != nullptr) {
    if (parsed.value().contains("mesh"))
      return Error{"body.mesh is given as a key and as arrays; leave one of them out"};
    parsed.value()["mesh"] = {{"box", Json::object()}};  // in its place, for the checks
  }
  if (!parsed.value().contains("name")) parsed.value()["name"] = BodyDef{}.name;
  for (const char* key : {"velocity", "angular_velocity"}) {
    if (parsed.value().contains(key)) {
      return Error{std::string("body.") + key +
                   " belongs to a scene; set the velocities of the body when it is in a world"};
    }
  }
  keys::BodyKeys part;
  ReadContext context;
  if (auto r = read_part(parsed.value(), "body", context, part); !r) return r.failure();
  const SceneBody& def = part.body;
  if (auto r = check_name("body", def.name); !r) return r.failure();
  if (auto r = check_body("body", def); !r) return r.failure();
  auto made = make_body(def, folder, "body", mesh);
  if (!made) return made.failure();
  return std::move(made.value().def);
}

Result<WorldOptions> options_from_keys(std::string_view json) {
  auto parsed = parse_part(json, "options");
  if (!parsed) return parsed.failure();
  for (const char* key : {"duration", "steps", "step", "path_step"}) {
    if (parsed.value().contains(key)) {
      return Error{std::string("options.") + key +
                   " belongs to a scene; a world is told the length of each step when it is made"};
    }
  }
  keys::WorldKeys world;
  ReadContext context;
  if (auto r = read_part(parsed.value(), "options", context, world); !r) return r.failure();
  AnalysisDef& analysis = world.analysis;
  if (auto r = check_analysis("options", analysis); !r) return r.failure();
  if (auto r = check_curve("options.gravity_amount", analysis.options.gravity_curve); !r) return r.failure();
  if (world.follow && analysis.type != AnalysisType::statics)
    return Error{"options.follow belongs to statics; remove it or set options.type to \"static\""};
  if (world.follow) analysis.path_step = 1;  // its scheme; lengths are given to World::follow()
  analysis.options.scheme = make_scheme(analysis);
  return analysis.options;
}

std::vector<std::string> effect_kinds_known() {
  std::vector<std::string> words;
  for (const EffectEntry& entry : table().entries) words.push_back(entry.word);
  return words;
}

std::string effect_keys_json() {
  const keys::Catalog& catalog = table().catalog;
  Json all = Json::object();
  for (const EffectEntry& entry : table().entries) {
    const keys::CatalogObject& object = catalog.of(entry.word);
    all[entry.word] = {{"list", entry.kind->key},
                       {"what", keys::plain_text(object.what)},
                       {"keys", keys_of(catalog, object)}};
  }
  return scene_json::text_of(all) + "\n";
}

std::string part_keys_json() {
  const Json all{{"material", part_of<MaterialDef>()},
                 {"body", part_of<keys::BodyKeys>()},
                 {"options", part_of<keys::WorldKeys>()}};
  return scene_json::text_of(all) + "\n";
}

}  // namespace isochor
