#include "scenes/keys/catalog.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "scenes/keys/parts.h"

namespace isochor::keys {

namespace {

std::string json_of(double v) {
  if (std::isinf(v)) return "\"inf\"";
  // The fewest digits that read back as the same number.
  char text[40];
  for (int digits = 6; digits <= 17; ++digits) {
    std::snprintf(text, sizeof text, "%.*g", digits, v);
    if (std::stod(text) == v) break;
  }
  return text;
}

std::string json_of(const Vec3& v) {
  return "[" + json_of(v.x) + ", " + json_of(v.y) + ", " + json_of(v.z) + "]";
}

std::string json_of(const std::string& text) {
  return text.empty() ? "" : "\"" + text + "\"";
}

// Lists keys and leaves values alone.
class Cataloger final : public Visitor {
 public:
  explicit Cataloger(Catalog& catalog) : catalog_(catalog) {}
  const std::string& type() const { return type_; }

  void about(const char* type, const char* what) override {
    type_ = type;
    for (const CatalogObject& o : catalog_.objects) known_ = known_ || o.type == type_;
    if (known_) return;
    index_ = catalog_.objects.size();
    catalog_.objects.push_back({type_, what, {}, {}, {}});
  }
  void text(const Key& key, std::string&, const std::string& standard) override {
    add(key, "text", json_of(standard));
  }
  void required_text(const Key& key, std::string&) override { add(key.must(), "text"); }
  void number(const Key& key, double&, double standard) override { add(key, "number", json_of(standard)); }
  void number_or_inf(const Key& key, double&, double standard) override {
    add(key, "number or inf", json_of(standard));
  }
  void optional_number(const Key& key, std::optional<double>&) override { add(key, "number"); }
  void integer(const Key& key, int&, int standard) override { add(key, "integer", json_of(standard)); }
  void flag(const Key& key, bool&, bool standard) override { add(key, "flag", standard ? "true" : "false"); }
  void vector(const Key& key, Vec3&, const Vec3& standard) override { add(key, "vector", json_of(standard)); }
  void required_vector(const Key& key, Vec3&) override { add(key.must(), "vector"); }
  void optional_vector(const Key& key, std::optional<Vec3>&) override { add(key, "vector"); }
  void integers(const Key& key, std::array<int, 3>&) override { add(key, "integers"); }
  void names(const Key& key, std::vector<std::string>&) override { add(key, "names"); }
  void indices(const Key& key, std::vector<Index>&) override { add(key, "indices"); }
  void numbers(const Key& key, std::vector<double>&) override { add(key, "numbers"); }
  void points(const Key& key, std::vector<Vec3>&) override { add(key, "points"); }
  void paths(const Key& key, std::vector<std::vector<Vec3>>&) override { add(key, "paths"); }
  void boxes(const Key& key, std::vector<std::array<Vec3, 2>>&) override { add(key, "boxes"); }
  void optional_box(const Key& key, std::optional<std::array<Vec3, 2>>&) override { add(key, "box"); }
  void directions(const Key& key, std::vector<Vec3>&) override { add(key, "directions"); }
  void angle(const Key& radians, const Key& degrees, double&) override {
    if (!known_) catalog_.objects[index_].one_of = {radians.name, degrees.name};
    add(radians, "number");
    add(degrees, "number");
  }
  void optional_angle(const Key& radians, const Key& degrees, double&, double standard) override {
    not_both(radians.name, degrees.name);
    add(radians, "number", json_of(standard));
    add(degrees, "number");
  }
  void body(const Key& key, BodyId&) override {
    add(key.needed ? key : key.absent("the first body"), "text");
  }
  void optional_body(const Key& key, std::optional<BodyId>&) override { add(key, "text"); }
  void curve(const Key& key, Curve&, CurveStart, bool) override { add(key, "curve", "1"); }
  void required_curve(const Key& key, Curve&, CurveStart) override { add(key.must(), "curve"); }
  void note(const Key& key) override { add(key, "text"); }
  void not_both(const char* a, const char* b) override {
    if (!known_) catalog_.objects[index_].not_both.push_back({a, b});
  }
  // The description goes on with a file; the other forms follow.
  void mesh_form(std::variant<MeshFile, BoxMeshDef, LatticeMesh>& mesh) override {
    mesh = MeshFile{};
    if (!known_) catalog_.objects[index_].one_of = {"file", "box", "lattice"};
    if (!known_) catalog_.objects[index_].rest_with_first = true;
    BoxMeshDef box;
    LatticeMesh lattice;
    object({"box", "", "instead of a file"}, box);
    object({"lattice", "", "instead of a file"}, lattice);
  }
  void bodies_known(const std::vector<SceneBody>&) override {}
  void analysis_known(const AnalysisDef&) override {}

 protected:
  void choice(const Key& key, int&, int standard, std::span<const Word> words) override {
    CatalogKey* added = add(key, "word");
    if (!added) return;
    for (const Word& word : words) {
      if (word.value == standard && added->standard.empty())
        added->standard = json_of(std::string(word.name));
      added->words.emplace_back(word.name);
    }
  }
  void object_at(const Key& key, const Object& object) override { add_object(key.must(), "object", object); }
  void settings_at(const Key& key, const Object& object) override { add_object(key, "object", object); }
  bool optional_at(const Key& key, const Object& object, bool) override {
    add_object(key, "object", object);
    return false;
  }
  bool list_at(const Key& key, const List& list, bool) override {
    add_object(key, "list", list.append(list.list));
    return false;
  }

 private:
  CatalogKey* add(const Key& key, const char* kind, std::string standard = {}) {
    if (known_) return nullptr;
    const bool told = key.needed || *key.without != '\0';
    CatalogObject& object = catalog_.objects[index_];
    // Of several forms none is needed: one of them is.
    const bool form = std::find(object.one_of.begin(), object.one_of.end(), key.name) != object.one_of.end();
    object.keys.push_back({key.name,
                           key.unit,
                           key.meaning,
                           kind,
                           told ? "" : std::move(standard),
                           key.without,
                           "",
                           {},
                           key.needed && !form,
                           key.bounds});
    return &object.keys.back();
  }
  void add_object(const Key& key, const char* kind, const Object& object) {
    if (known_) return;
    add(key, kind);
    const std::size_t place = catalog_.objects[index_].keys.size() - 1;
    Cataloger inner(catalog_);
    object.keys(inner, object.value);
    catalog_.objects[index_].keys[place].type = inner.type();
  }

  Catalog& catalog_;
  std::string type_;
  std::size_t index_ = 0;
  bool known_ = false;  // listed before
};

}  // namespace

const CatalogObject& Catalog::of(const std::string& type) const {
  for (const CatalogObject& o : objects) {
    if (o.type == type) return o;
  }
  return objects.front();
}

Catalog catalog_of(const Object& object) {
  Catalog catalog;
  Cataloger all(catalog);
  object.keys(all, object.value);
  return catalog;
}

Catalog catalog_of_scene() {
  SceneDef scene;
  return catalog_of(object_of(scene));
}

}  // namespace isochor::keys
