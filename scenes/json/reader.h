// Reads an object of a scene file strictly: unknown keys, wrong types and values out of range are errors that
// name the place, the value and the remedy. The first error is kept, what follows is skipped.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenes/json/describe.h"

namespace isochor::scene_json {

using Json = nlohmann::ordered_json;

// What a whole file shares.
struct ReadContext {
  std::string error;
  std::vector<std::string> bodies;
  AnalysisType analysis = AnalysisType::statics;

  void fail(const std::string& where, const std::string& message) {
    if (error.empty()) error = where.empty() ? message : where + ": " + message;
  }
};

// The value as it stands in the file, shortened.
std::string shown(const Json& value);
// The word nearest to `word`, as ", did you mean \"...\"?", or nothing when none is near.
std::string suggestion(const std::string& word, const std::vector<std::string>& known);

class Reader {
 public:
  Reader(const Json& json, std::string place, ReadContext& context)
      : json_(json), place_(std::move(place)), context_(context) {
    if (!json_.is_object()) fail_here("expected an object {...}, found " + shown(json_));
  }

  void text(const char* key, std::string& value);
  void required_text(const char* key, std::string& value);
  void number(const char* key, double& value, double standard);
  void number_or_inf(const char* key, double& value, double standard);
  void optional_number(const char* key, std::optional<double>& value);
  void integer(const char* key, int& value, int standard);
  void flag(const char* key, bool& value, bool standard);
  void vector(const char* key, Vec3& value, const Vec3& standard);
  void required_vector(const char* key, Vec3& value);
  void optional_vector(const char* key, std::optional<Vec3>& value);
  void paths(const char* key, std::vector<std::vector<Vec3>>& value);
  void integers(const char* key, std::array<int, 3>& value);
  void names(const char* key, std::vector<std::string>& value);  // a list, or one name
  void indices(const char* key, std::vector<Index>& value);
  void numbers(const char* key, std::vector<double>& value);
  void points(const char* key, std::vector<Vec3>& value);
  void boxes(const char* key, std::vector<std::array<Vec3, 2>>& value);
  void directions(const char* key, std::vector<Vec3>& value);  // "xz", or vectors
  void angle(const char* radians, const char* degrees, double& value);
  void optional_angle(const char* radians, const char* degrees, double& value, double standard);
  void optional_box(const char* key, std::optional<std::array<Vec3, 2>>& value);
  void body(const char* key, BodyId& value);
  void optional_body(const char* key, std::optional<BodyId>& value);
  void curve(const char* key, Curve& value, CurveStart start, bool matters);
  void required_curve(const char* key, Curve& value, CurveStart start);
  void note(const char* key);
  void not_both(const char* a, const char* b);
  void either(const char* file, const char* box, const char* lattice,
              std::variant<MeshFile, BoxMeshDef, LatticeMesh>& mesh);

  template <class E>
  void word(const char* key, E& value, E) {
    const Json* j = find(key);
    if (!j) return;
    std::vector<std::string> known;
    for (const auto& [e, name] : Words<E>::list) {
      if (j->is_string() && j->get_ref<const std::string&>() == name) {
        value = e;
        return;
      }
      known.emplace_back(name);
    }
    fail_word(key, *j, known);
  }

  template <class T>
  void object(const char* key, T& value) {
    const Json* j = find(key);
    if (j)
      read_object(*j, at(key), value);
    else if (needs_object<T>)
      fail_here(std::string("\"") + key + "\" is missing");
  }
  template <class T>
  void optional_object(const char* key, T& value, bool) {
    if (const Json* j = find(key)) read_object(*j, at(key), value);
  }
  template <class T>
  void maybe_object(const char* key, std::optional<T>& value) {
    if (const Json* j = find(key)) read_object(*j, at(key), value.emplace());
  }
  template <class T>
  void list(const char* key, std::vector<T>& value) {
    if (const Json* j = find(key)) read_list(*j, key, value);
  }
  template <class T>
  void optional_list(const char* key, std::optional<std::vector<T>>& value) {
    if (const Json* j = find(key)) read_list(*j, key, value.emplace());
  }

  void bodies_known(const std::vector<SceneBody>& bodies) {
    for (const auto& b : bodies) context_.bodies.push_back(b.name);
  }
  void analysis_known(const AnalysisDef& analysis) { context_.analysis = analysis.type; }

  // Names the first key that no description asked for.
  void finish();

 private:
  // Everything but the parts that have defaults of their own.
  template <class T>
  static constexpr bool needs_object = !std::is_same_v<T, AnalysisDef> && !std::is_same_v<T, OutputDef>;

  template <class T>
  void read_object(const Json& j, const std::string& where, T& value) {
    Reader inner(j, where, context_);
    describe(inner, value);
    inner.finish();
  }
  template <class T>
  void read_list(const Json& j, const char* key, std::vector<T>& value) {
    if (!expect_list(j, key)) return;
    for (std::size_t i = 0; i < j.size() && context_.error.empty(); ++i) {
      read_object(j[i], at(key) + "[" + std::to_string(i) + "]", value.emplace_back());
    }
  }

  const Json* find(const char* key);
  const Json* require(const char* key);
  std::string at(const std::string& key) const { return place_.empty() ? key : place_ + "." + key; }
  void fail_here(const std::string& message) { context_.fail(place_, message); }
  void fail_type(const std::string& where, const char* expected, const Json& j);
  void fail_word(const char* key, const Json& j, const std::vector<std::string>& known);
  bool expect_list(const Json& j, const char* key);
  bool read_number(const Json& j, const std::string& where, double& value);
  bool read_integer(const Json& j, const std::string& where, int& value);
  bool read_vector(const Json& j, const std::string& where, Vec3& value);
  bool read_box(const Json& j, const std::string& where, std::array<Vec3, 2>& value);
  void read_curve(const Json& j, const std::string& where, Curve& value, CurveStart start);
  void read_plain_curve(double end, Curve& value, CurveStart start) const;
  void read_direction(const Json& j, const std::string& where, std::vector<Vec3>& value);

  const Json& json_;
  std::string place_;
  ReadContext& context_;
  std::vector<std::string> known_;
};

}  // namespace isochor::scene_json
