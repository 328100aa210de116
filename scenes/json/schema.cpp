// The JSON Schema of scene files, made from the catalog of keys.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "scenes/json/text.h"
#include "scenes/keys/catalog.h"
#include "scenes/scene_file.h"

namespace isochor {

namespace {

using scene_json::Json;

Json reference(const std::string& name) {
  return {{"$ref", "#/$defs/" + name}};
}

Json list_of(Json items, int least = 0, int most = 0) {
  Json list{{"type", "array"}, {"items", std::move(items)}};
  if (least > 0) list["minItems"] = least;
  if (most > 0) list["maxItems"] = most;
  return list;
}

// What several keys share.
void add_common(Json& defs) {
  const Json number{{"type", "number"}}, letters{{"type", "string"}, {"pattern", "^[xyz]+$"}};
  defs["vector"] = list_of(number, 3, 3);
  defs["names"] = {{"description", "One name or several."},
                   {"anyOf", {{{"type", "string"}}, list_of({{"type", "string"}})}}};
  defs["paths"] = list_of(list_of(reference("vector"), 2));
  defs["number_or_inf"] = {{"anyOf", {number, {{"const", "inf"}}}}};
  defs["curve"] = {{"description",
                    "A number or points [time, value], linear between them and constant outside. A number is "
                    "reached at time "
                    "1 in statics (from 0; from 1 for a ratio, gas or liquid) and holds from the start in "
                    "dynamics and for a "
                    "volume, a length or a valve."},
                   {"anyOf", {number, list_of(list_of(number, 2, 2), 1)}}};
  defs["directions"] = {
      {"description", "Letters of x, y and z, as in \"xz\", or vectors. Absent: all directions."},
      {"anyOf", {letters, list_of({{"anyOf", {letters, reference("vector")}}}, 1)}}};
}

Json kind_of(const keys::CatalogKey& key) {
  if (key.kind == "text") return {{"type", "string"}};
  if (key.kind == "flag") return {{"type", "boolean"}};
  if (key.kind == "word") return {{"enum", key.words}};
  if (key.kind == "number or inf") return reference("number_or_inf");
  if (key.kind == "integers") return list_of({{"type", "integer"}}, 3, 3);
  if (key.kind == "indices") return list_of({{"type", "integer"}, {"minimum", 0}});
  if (key.kind == "numbers") return list_of({{"type", "number"}});
  if (key.kind == "points") return list_of(reference("vector"));
  if (key.kind == "box") return list_of(reference("vector"), 2, 2);
  if (key.kind == "boxes") return list_of(list_of(reference("vector"), 2, 2));
  if (key.kind == "object") return reference(key.type);
  if (key.kind == "list") return list_of(reference(key.type), key.needed ? 1 : 0);
  if (key.kind == "number" || key.kind == "integer") return {{"type", key.kind}};
  return reference(key.kind);  // vector, names, paths, curve, directions
}

void add_bounds(Json& schema, const keys::Bounds& b) {
  Json& of = schema.contains("items") ? schema["items"] : schema;
  if (b.least) of["minimum"] = scene_json::plain_number(*b.least);
  if (b.above) of["exclusiveMinimum"] = scene_json::plain_number(*b.above);
  if (b.most) of["maximum"] = scene_json::plain_number(*b.most);
}

Json schema_of(const keys::CatalogKey& key) {
  Json schema = kind_of(key);
  add_bounds(schema, key.bounds);
  if (!key.standard.empty()) schema["default"] = Json::parse(key.standard);
  std::string text = keys::plain_text(key.meaning);
  if (!key.unit.empty()) text += (text.empty() ? "[" : " [") + key.unit + "]";
  if (!key.without.empty()) text += "; default: " + keys::plain_text(key.without);
  if (!text.empty()) schema["description"] = text;
  return schema;
}

// Of the forms of an object: this one, without the keys that go with the first.
Json form_of(const keys::CatalogObject& object, std::size_t form) {
  Json schema{{"required", {object.one_of[form]}}};
  if (form == 0) return schema;
  Json others = Json::array();
  for (const keys::CatalogKey& key : object.keys) {
    const bool is_form =
        std::find(object.one_of.begin(), object.one_of.end(), key.name) != object.one_of.end();
    if (!is_form && object.rest_with_first) others.push_back({{"required", {key.name}}});
  }
  if (!others.empty()) schema["not"] = {{"anyOf", others}};
  return schema;
}

Json schema_of(const keys::CatalogObject& object) {
  Json schema{{"type", "object"}};
  if (!object.what.empty()) schema["description"] = keys::plain_text(object.what);
  Json required = Json::array();
  for (const keys::CatalogKey& key : object.keys) {
    if (key.needed) required.push_back(key.name);
  }
  if (!required.empty()) schema["required"] = required;
  schema["additionalProperties"] = false;
  Json& properties = schema["properties"] = Json::object();
  for (const keys::CatalogKey& key : object.keys) properties[key.name] = schema_of(key);
  for (std::size_t f = 0; f < object.one_of.size(); ++f) schema["oneOf"].push_back(form_of(object, f));
  for (const auto& [a, b] : object.not_both) schema["not"] = {{"required", {a, b}}};
  return schema;
}

}  // namespace

std::string scene_schema() {
  const keys::Catalog catalog = keys::catalog_of_scene();
  Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "Isochor scene"}};
  const Json scene = schema_of(catalog.objects.front());
  for (const auto& [key, value] : scene.items()) schema[key] = value;
  Json& defs = schema["$defs"];
  add_common(defs);
  for (const keys::CatalogObject& object : catalog.objects) {
    if (&object != &catalog.objects.front()) defs[object.type] = schema_of(object);
  }
  return scene_json::text_of(schema) + "\n";
}

std::vector<std::string> scene_file_keys() {
  std::vector<std::string> out;
  const keys::Catalog catalog = keys::catalog_of_scene();
  walk(catalog, catalog.objects.front(), "",
       [&](const std::string& place, const keys::CatalogObject& object) {
         for (const keys::CatalogKey& key : object.keys) {
           std::string kind;
           for (const std::string& word : key.words) kind += (kind.empty() ? "" : "|") + word;
           if (kind.empty()) kind = key.kind == "box" ? "points" : key.kind;
           out.push_back((place.empty() ? "" : place + ".") + key.name + ": " + kind);
         }
       });
  return out;
}

std::string scene_key_tables() {
  return keys::key_tables(keys::catalog_of_scene());
}

std::string scene_key_lines() {
  return keys::key_lines(keys::catalog_of_scene());
}

}  // namespace isochor
