// Writes a scene as a scene file: values at their defaults are left out.
#pragma once

#include "scenes/json/text.h"
#include "scenes/keys/keys.h"

namespace isochor::scene_json {

using keys::CurveStart;
using keys::Key;

class Writer final : public keys::Visitor {
 public:
  Writer(Json& json, const SceneDef& scene) : json_(json), scene_(scene) { json_ = Json::object(); }

  void about(const char*, const char*) override {}
  void text(const Key& key, std::string& value, const std::string&) override {
    if (!value.empty()) json_[key.name] = value;
  }
  void required_text(const Key& key, std::string& value) override { json_[key.name] = value; }
  void number(const Key& key, double& value, double standard) override {
    if (value != standard) json_[key.name] = plain_number(value);
  }
  void number_or_inf(const Key& key, double& value, double standard) override;
  void optional_number(const Key& key, std::optional<double>& value) override {
    if (value) json_[key.name] = plain_number(*value);
  }
  void integer(const Key& key, int& value, int standard) override {
    if (value != standard) json_[key.name] = value;
  }
  void flag(const Key& key, bool& value, bool standard) override {
    if (value != standard) json_[key.name] = value;
  }
  void vector(const Key& key, Vec3& value, const Vec3& standard) override {
    if (!(value == standard)) json_[key.name] = list_of(value);
  }
  void required_vector(const Key& key, Vec3& value) override { json_[key.name] = list_of(value); }
  void optional_vector(const Key& key, std::optional<Vec3>& value) override {
    if (value) json_[key.name] = list_of(*value);
  }
  void integers(const Key& key, std::array<int, 3>& value) override { json_[key.name] = value; }
  void names(const Key& key, std::vector<std::string>& value) override { plain_list(key, value); }
  void indices(const Key& key, std::vector<Index>& value) override { plain_list(key, value); }
  void numbers(const Key& key, std::vector<double>& value) override { plain_list(key, value); }
  void points(const Key& key, std::vector<Vec3>& value) override;
  void paths(const Key& key, std::vector<std::vector<Vec3>>& value) override;
  void boxes(const Key& key, std::vector<std::array<Vec3, 2>>& value) override;
  void optional_box(const Key& key, std::optional<std::array<Vec3, 2>>& value) override {
    if (value) json_[key.name] = Json::array({list_of((*value)[0]), list_of((*value)[1])});
  }
  void directions(const Key& key, std::vector<Vec3>& value) override;
  void angle(const Key& radians, const Key&, double& value) override {
    json_[radians.name] = plain_number(value);
  }
  void optional_angle(const Key& radians, const Key&, double& value, double standard) override {
    number(radians, value, standard);
  }
  void body(const Key& key, BodyId& value) override;
  void optional_body(const Key& key, std::optional<BodyId>& value) override;
  void curve(const Key& key, Curve& value, CurveStart start, bool matters) override {
    if (matters) required_curve(key, value, start);
  }
  void required_curve(const Key& key, Curve& value, CurveStart start) override;
  void note(const Key&) override {}
  void not_both(const char*, const char*) override {}
  void mesh_form(std::variant<MeshFile, BoxMeshDef, LatticeMesh>&) override {}
  void bodies_known(const std::vector<SceneBody>&) override {}
  void analysis_known(const AnalysisDef&) override {}

 protected:
  void choice(const Key& key, int& value, int standard, std::span<const keys::Word> words) override;
  void object_at(const Key& key, const keys::Object& object) override { write(json_[key.name], object); }
  void settings_at(const Key& key, const keys::Object& object) override;
  bool optional_at(const Key& key, const keys::Object& object, bool present) override;
  bool list_at(const Key& key, const keys::List& list, bool present) override;

 private:
  void write(Json& json, const keys::Object& object) {
    Writer inner(json, scene_);
    object.keys(inner, object.value);
  }
  template <class T>
  void plain_list(const Key& key, const std::vector<T>& value) {
    if (!value.empty()) json_[key.name] = value;
  }
  static Json list_of(const Vec3& v) {
    return Json::array({plain_number(v.x), plain_number(v.y), plain_number(v.z)});
  }

  Json& json_;
  const SceneDef& scene_;
};

}  // namespace isochor::scene_json
