// All keys of a scene file as a list: what the schema, the tables of docs/scenes.md and `isochor keys` are
// made from.
#pragma once

#include "scenes/keys/keys.h"

namespace isochor::keys {

struct CatalogKey {
  std::string name, unit, meaning;
  std::string kind;      // "number", "vector", "curve", ..., "word", "object", "list"
  std::string standard;  // the default as JSON; empty: none
  std::string without;   // what absence means where no default says it
  std::string type;      // of an object or of the entries of a list: CatalogObject::type
  std::vector<std::string> words;
  bool needed = false;
  Bounds bounds;
};

struct CatalogObject {
  std::string type, what;
  std::vector<CatalogKey> keys;
  std::vector<std::array<std::string, 2>> not_both;
  std::vector<std::string> one_of;  // exactly one of these
  bool rest_with_first = false;     // the keys that are not among them go with the first
};

struct Catalog {
  std::vector<CatalogObject> objects;  // the scene first
  const CatalogObject& of(const std::string& type) const;
};

Catalog catalog_of_scene();
// Of any object that has a description, this one first.
Catalog catalog_of(const Object& object);

// Calls visit(place, object) for every place where an object may stand, "" for the scene, then
// "bodies[]", "bodies[].mesh", ...
template <class Visit>
void walk(const Catalog& catalog, const CatalogObject& object, const std::string& place, const Visit& visit) {
  visit(place, object);
  for (const CatalogKey& key : object.keys) {
    if (key.type.empty()) continue;
    const std::string at = (place.empty() ? "" : place + ".") + key.name + (key.kind == "list" ? "[]" : "");
    walk(catalog, catalog.of(key.type), at, visit);
  }
}

// Tables of every key for docs/scenes.md.
std::string key_tables(const Catalog& catalog);
// One line a key for a terminal.
std::string key_lines(const Catalog& catalog);
// The text without the marks of Markdown.
std::string plain_text(const std::string& markdown);

}  // namespace isochor::keys
