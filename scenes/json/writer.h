// Writes a scene as a scene file: values at their defaults are left out.
#pragma once

#include <nlohmann/json.hpp>
#include <type_traits>

#include "scenes/json/describe.h"

namespace isochor::scene_json {

using Json = nlohmann::ordered_json;

// Whole numbers without a decimal point.
Json plain_number(double value);

class Writer {
 public:
  Writer(Json& json, const SceneDef& scene) : json_(json), scene_(scene) { json_ = Json::object(); }

  void text(const char* key, const std::string& value) {
    if (!value.empty()) json_[key] = value;
  }
  void required_text(const char* key, const std::string& value) { json_[key] = value; }
  void number(const char* key, double value, double standard) {
    if (value != standard) json_[key] = plain_number(value);
  }
  void number_or_inf(const char* key, double value, double standard);
  void optional_number(const char* key, const std::optional<double>& value) {
    if (value) json_[key] = plain_number(*value);
  }
  void integer(const char* key, int value, int standard) {
    if (value != standard) json_[key] = value;
  }
  void flag(const char* key, bool value, bool standard) {
    if (value != standard) json_[key] = value;
  }
  void vector(const char* key, const Vec3& value, const Vec3& standard) {
    if (!(value == standard)) json_[key] = list_of(value);
  }
  void required_vector(const char* key, const Vec3& value) { json_[key] = list_of(value); }
  void optional_vector(const char* key, const std::optional<Vec3>& value) {
    if (value) json_[key] = list_of(*value);
  }
  void paths(const char* key, const std::vector<std::vector<Vec3>>& value) {
    if (value.empty()) return;
    json_[key] = Json::array();
    for (const auto& path : value) {
      Json points = Json::array();
      for (const Vec3& p : path) points.push_back(list_of(p));
      json_[key].push_back(std::move(points));
    }
  }
  void integers(const char* key, const std::array<int, 3>& value) { json_[key] = value; }
  void names(const char* key, const std::vector<std::string>& value) {
    if (!value.empty()) json_[key] = value;
  }
  void indices(const char* key, const std::vector<Index>& value) {
    if (!value.empty()) json_[key] = value;
  }
  void numbers(const char* key, const std::vector<double>& value) {
    if (!value.empty()) json_[key] = value;
  }
  void points(const char* key, const std::vector<Vec3>& value);
  void boxes(const char* key, const std::vector<std::array<Vec3, 2>>& value);
  void directions(const char* key, const std::vector<Vec3>& value);
  void angle(const char* radians, const char*, double value) { json_[radians] = plain_number(value); }
  void optional_angle(const char* radians, const char*, double value, double standard) {
    number(radians, value, standard);
  }
  void optional_box(const char* key, const std::optional<std::array<Vec3, 2>>& value) {
    if (value) json_[key] = Json::array({list_of((*value)[0]), list_of((*value)[1])});
  }
  void body(const char* key, BodyId value);
  void optional_body(const char* key, const std::optional<BodyId>& value);
  void curve(const char* key, const Curve& value, CurveStart start, bool matters) {
    if (matters) required_curve(key, value, start);
  }
  void required_curve(const char* key, const Curve& value, CurveStart start);
  void note(const char*) {}
  void not_both(const char*, const char*) {}
  void either(const char*, const char*, const char*, const std::variant<MeshFile, BoxMeshDef, LatticeMesh>&) {
  }

  template <class E>
  void word(const char* key, E value, E standard) {
    if (value == standard) return;
    for (const auto& [e, name] : Words<E>::list) {
      if (e == value) json_[key] = name;
    }
  }
  template <class T>
  void object(const char* key, T& value) {
    Json inner;
    write(inner, value);
    // A selection must be there: what holds points alone selects no nodes.
    constexpr bool required = std::is_same_v<T, Selection>;
    if (required && inner.is_null()) inner = Json::object();
    if (required || !inner.empty()) json_[key] = std::move(inner);
  }
  template <class T>
  void optional_object(const char* key, T& value, bool present) {
    if (present) write(json_[key], value);
  }
  template <class T>
  void maybe_object(const char* key, std::optional<T>& value) {
    if (value) write(json_[key], *value);
  }
  template <class T>
  void list(const char* key, std::vector<T>& value) {
    if (!value.empty()) write_list(key, value);
  }
  template <class T>
  void optional_list(const char* key, std::optional<std::vector<T>>& value) {
    if (value) write_list(key, *value);
  }
  void bodies_known(const std::vector<SceneBody>&) {}
  void analysis_known(const AnalysisDef&) {}

 private:
  template <class T>
  void write(Json& json, T& value) {
    Writer inner(json, scene_);
    describe(inner, value);
  }
  template <class T>
  void write_list(const char* key, std::vector<T>& value) {
    Json& all = json_[key] = Json::array();
    for (T& item : value) {
      all.push_back(Json::object());
      write(all.back(), item);
    }
  }
  static Json list_of(const Vec3& v) {
    return Json::array({plain_number(v.x), plain_number(v.y), plain_number(v.z)});
  }

  Json& json_;
  const SceneDef& scene_;
};

}  // namespace isochor::scene_json
