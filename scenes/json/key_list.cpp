// What the parser knows, as a list that a test compares with the schema.
#include "scenes/json/describe.h"
#include "scenes/scene_file.h"

namespace isochor {

namespace scene_json {

namespace {

class KeyList {
 public:
  KeyList(std::string place, std::vector<std::string>& out) : place_(std::move(place)), out_(out) {}

  void text(const char* key, std::string&) { add(key, "text"); }
  void required_text(const char* key, std::string&) { add(key, "text"); }
  void number(const char* key, double&, double) { add(key, "number"); }
  void number_or_inf(const char* key, double&, double) { add(key, "number or inf"); }
  void optional_number(const char* key, std::optional<double>&) { add(key, "number"); }
  void integer(const char* key, int&, int) { add(key, "integer"); }
  void flag(const char* key, bool&, bool) { add(key, "flag"); }
  void vector(const char* key, Vec3&, const Vec3&) { add(key, "vector"); }
  void required_vector(const char* key, Vec3&) { add(key, "vector"); }
  void optional_vector(const char* key, std::optional<Vec3>&) { add(key, "vector"); }
  void paths(const char* key, std::vector<std::vector<Vec3>>&) { add(key, "paths"); }
  void integers(const char* key, std::array<int, 3>&) { add(key, "integers"); }
  void names(const char* key, std::vector<std::string>&) { add(key, "names"); }
  void indices(const char* key, std::vector<Index>&) { add(key, "indices"); }
  void numbers(const char* key, std::vector<double>&) { add(key, "numbers"); }
  void points(const char* key, std::vector<Vec3>&) { add(key, "points"); }
  void boxes(const char* key, std::vector<std::array<Vec3, 2>>&) { add(key, "boxes"); }
  void directions(const char* key, std::vector<Vec3>&) { add(key, "directions"); }
  void angle(const char* radians, const char* degrees, double&) {
    add(radians, "number");
    add(degrees, "number");
  }
  void optional_angle(const char* radians, const char* degrees, double& value, double) {
    angle(radians, degrees, value);
  }
  void optional_box(const char* key, std::optional<std::array<Vec3, 2>>&) { add(key, "points"); }
  void body(const char* key, BodyId&) { add(key, "text"); }
  void optional_body(const char* key, std::optional<BodyId>&) { add(key, "text"); }
  void curve(const char* key, Curve&, CurveStart, bool) { add(key, "curve"); }
  void required_curve(const char* key, Curve&, CurveStart) { add(key, "curve"); }
  void note(const char* key) { add(key, "text"); }
  void not_both(const char*, const char*) {}
  // The description looks into one form of a mesh; the others are told here.
  void either(const char*, const char* box, const char* lattice,
              std::variant<MeshFile, BoxMeshDef, LatticeMesh>&) {
    BoxMeshDef def;
    object(box, def);
    LatticeMesh cubes;
    object(lattice, cubes);
  }
  template <class E>
  void word(const char* key, E&, E) {
    std::string kind;
    for (const auto& [e, name] : Words<E>::list) kind += (kind.empty() ? "" : "|") + std::string(name);
    add(key, kind);
  }
  template <class T>
  void object(const char* key, T& value) {
    add(key, "object");
    KeyList inner(at(key), out_);
    describe(inner, value);
  }
  template <class T>
  void optional_object(const char* key, T& value, bool) {
    object(key, value);
  }
  template <class T>
  void maybe_object(const char* key, std::optional<T>&) {
    T value;
    object(key, value);
  }
  template <class T>
  void list(const char* key, std::vector<T>&) {
    add(key, "list");
    T item;
    KeyList inner(at(key) + "[]", out_);
    describe(inner, item);
  }
  template <class T>
  void optional_list(const char* key, std::optional<std::vector<T>>&) {
    std::vector<T> items;
    list(key, items);
  }
  void bodies_known(const std::vector<SceneBody>&) {}
  void analysis_known(const AnalysisDef&) {}

 private:
  std::string at(const std::string& key) const { return place_.empty() ? key : place_ + "." + key; }
  void add(const std::string& key, const std::string& kind) { out_.push_back(at(key) + ": " + kind); }

  std::string place_;
  std::vector<std::string>& out_;
};

}  // namespace

}  // namespace scene_json

std::vector<std::string> scene_file_keys() {
  std::vector<std::string> out;
  SceneDef scene;
  scene_json::KeyList keys("", out);
  scene_json::describe(keys, scene);
  return out;
}

}  // namespace isochor
