// The published schema, the tables of the docs and the parser know the same keys, kinds and words; both are
// what scenes/make_keys.sh makes.
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "catch.h"
#include "scenes/keys/catalog.h"
#include "scenes/library.h"
#include "small_scene.h"

using namespace isochor;
using Json = nlohmann::ordered_json;

namespace {

std::string words_of(const Json& list) {
  std::string words;
  for (const auto& w : list) {
    words += words.empty() ? "" : "|";
    words += w.get<std::string>();
  }
  return words;
}

// The parser's name for what a schema allows.
std::string kind_of(const Json& schema, const std::string& reference) {
  if (schema.contains("enum")) return words_of(schema["enum"]);
  for (const char* kind : {"vector", "names", "curve", "directions", "paths"}) {
    if (reference == kind) return kind;
  }
  if (reference == "number_or_inf") return "number or inf";
  const std::string type = schema.value("type", "");
  if (type == "string") return "text";
  if (type == "boolean") return "flag";
  if (type != "array") return type;
  const Json& items = schema["items"];
  if (items.value("type", "") == "integer") return schema.contains("maxItems") ? "integers" : "indices";
  if (items.value("type", "") == "array") return "boxes";
  if (items.value("type", "") == "number") return "numbers";
  return items.value("$ref", "") == "#/$defs/vector" ? "points" : "list";
}

class SchemaKeys {
 public:
  explicit SchemaKeys(const Json& root) : root_(root) { walk(root, ""); }
  std::vector<std::string> keys;

 private:
  void walk(const Json& object, const std::string& place) {
    CHECK(object["additionalProperties"] == false);
    for (const auto& [key, value] : object["properties"].items()) {
      const std::string at = place.empty() ? key : place + std::string(".") + key;
      const std::string reference = name_of(value);
      const Json& schema = reference.empty() ? value : root_["$defs"][reference];
      const std::string kind = kind_of(schema, reference);
      keys.push_back(at + std::string(": ") + kind);
      if (kind == "object") walk(schema, at);
      if (kind == "list") walk(root_["$defs"][name_of(schema["items"])], at + std::string("[]"));
    }
  }
  static std::string name_of(const Json& schema) {
    const std::string reference = schema.value("$ref", "");
    return reference.empty() ? reference : reference.substr(reference.rfind('/') + 1);
  }
  const Json& root_;
};

}  // namespace

TEST_CASE("schema and parser know the same keys") {
  const Json schema = Json::parse(test::slurp(ISOCHOR_SCENES "/scene.schema.json"));
  auto published = SchemaKeys(schema).keys, known = scene_file_keys();
  std::sort(published.begin(), published.end());
  std::sort(known.begin(), known.end());
  std::vector<std::string> only_schema, only_parser;
  std::set_difference(published.begin(), published.end(), known.begin(), known.end(),
                      std::back_inserter(only_schema));
  std::set_difference(known.begin(), known.end(), published.begin(), published.end(),
                      std::back_inserter(only_parser));
  CHECK(only_schema == std::vector<std::string>{});
  CHECK(only_parser == std::vector<std::string>{});
  CHECK(known.size() > 80);
}

TEST_CASE("the published schema is the one that is made from the keys") {
  INFO("scenes/make_keys.sh remakes it");
  CHECK(test::slurp(ISOCHOR_SCENES "/scene.schema.json") == scene_schema());
}

TEST_CASE("the docs have every key, with its default, and no other") {
  const std::string docs = test::slurp(ISOCHOR_SOURCE "/docs/scenes.md");
  const std::string begin = "<!-- keys: made by scenes/make_keys.sh -->\n", end = "<!-- end of keys -->";
  const auto from = docs.find(begin), to = docs.find(end);
  REQUIRE(from != std::string::npos);
  REQUIRE(to != std::string::npos);
  INFO("scenes/make_keys.sh remakes them");
  CHECK(docs.substr(from + begin.size(), to - from - begin.size()) == scene_key_tables());
}

namespace {

// One effect of each list, and other places with bounds, on the block of small_text().
const std::map<std::string, std::string> kComplete = {
    {"volumes[]", R"({"name": "rows"})"},
    {"volumes[].zones[]", R"({"name": "all", "boxes": [[[-9, -9, -9], [9, 9, 9]]]})"},
    {"dirichlet[]",
     R"({"name": "x", "where": {"surfaces": "x0"}, "treatment": "stiffness", "stiffness": 1})"},
    {"cavities[]", R"({"name": "x", "surfaces": "outer", "control": "gas", "amount": 1})"},
    {"damping[]", R"({"name": "x", "viscosity": 1, "mass_rate": 1})"},
    {"epidermis[]", R"({"name": "x", "surfaces": "x1", "young": 1, "poisson": 0.3, "thickness": 1})"},
    {"membranes[]", R"({"name": "x", "surfaces": "x1", "young": 1, "thickness": 1})"},
    {"shells[]", R"({"name": "x", "surfaces": "x1", "young": 1, "thickness": 1})"},
    {"ties[]", R"({"name": "x", "where": {"surfaces": "x1"}, "to": "block", "stiffness": 1})"},
    {"cables[]", R"({"name": "x", "points": [[0.5, 0.5, 0.5], [1.5, 0.5, 0.5]], "amount": 1})"},
    {"windings[]", R"({"name": "x", "paths": [[[0.5, 0.5, 0.5], [1.5, 0.5, 0.5]]]})"},
    {"driven[]", R"({"name": "x", "nodes": [0], "times": [0], "positions": [[[0, 0, 0]]]})"},
    {"skins[]", R"({"name": "x", "where": {"nodes": [0]},
                    "bones": [{"keyframes": [{"t": 0}], "field": "none"}]})"},
    {"linear_constraints[]", R"({"name": "x", "terms": [{"point": [0.5, 0.5, 0.5]}]})"},
    {"linear_constraints[].terms[]", R"({"point": [0.5, 0.5, 0.5]})"},
    {"muscles[]", R"({"name": "x", "amount": 1})"},
    {"growth[]", R"({"name": "x", "linear": 0.1})"},
    {"springs[]", R"({"name": "x", "from": [0.5, 0.5, 0.5], "to": [9, 9, 9], "stiffness": 1})"},
    {"layers[]", R"({"name": "x", "surfaces": "x1", "stiffness": 1})"},
    {"rigid_bodies[]", R"({"name": "x", "shape": {"shape": "sphere", "radius": 1, "position": [9, 9, 9]}})"},
    {"contacts[]", R"({"name": "x", "obstacle": {"position": [0, 0, -9]}})"},
    {"surface_contacts[]", R"({"name": "x"})"},
    {"analysis", R"({"steps": 3})"},
    {"outputs", "{}"},
    {"bodies[].materials[]", R"({"young": 1000, "poisson": 0.3})"},
    {"bodies[]", ""},
};

}  // namespace

// What the schema forbids the reader or the world refuses, in a message that names the key.
TEST_CASE("bounds that the schema tells are held") {
  const keys::Catalog catalog = keys::catalog_of_scene();
  int tried = 0;
  walk(catalog, catalog.objects.front(), "",
       [&](const std::string& place, const keys::CatalogObject& object) {
         const auto complete = kComplete.find(place);
         if (complete == kComplete.end()) return;
         std::string path = place;
         for (auto at = path.find("[]"); at != std::string::npos; at = path.find("[]"))
           path.replace(at, 2, "[0]");
         for (const keys::CatalogKey& key : object.keys) {
           std::vector<double> bad;
           if (key.bounds.least) bad.push_back(*key.bounds.least - 1);
           if (key.bounds.above && key.without.empty()) bad.push_back(*key.bounds.above - 1);
           if (key.bounds.most) bad.push_back(*key.bounds.most + 1);
           for (const double value : bad) {
             Overrides set;
             if (place == "volumes[].zones[]") set.push_back(R"(volumes[0]={"space": "zone"})");
             if (!complete->second.empty()) set.push_back(path + "=" + complete->second);
             if (key.name == "sweeps")
               set.insert(set.end(), {"analysis.method=position_based", "analysis.type=dynamic"});
             if (key.name == "rings") set.push_back("volumes[0].space=ring");
             if (place == "damping[]" || place == "rigid_bodies[]" || key.name == "time_error")
               set.push_back("analysis.type=dynamic");
             set.push_back(
                 path + "." + key.name + "=" +
                 (key.kind == "integer" ? std::to_string(std::lround(value)) : std::to_string(value)));
             auto scene = parse_scene(test::small_text(), "s.json", ".", set);
             std::string error = scene ? "" : scene.error();
             if (scene) {
               auto built = build(scene.value());
               if (!built) error = built.error();
             }
             INFO(path << "." << key.name << " = " << value << ": " << error);
             const bool tolerance = key.name.ends_with("_tolerance");  // told together
             CHECK(error.find(tolerance ? "tolerances must" : key.name) != std::string::npos);
             ++tried;
           }
         }
       });
  CHECK(tried > 40);
}
