// The published schema and the parser know the same keys, kinds and words.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "catch.h"
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
