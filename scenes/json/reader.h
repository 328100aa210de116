// Reads an object of a scene file strictly: unknown keys, wrong types and values out of range are errors that
// name the place, the value and the remedy. The first error is kept, what follows is skipped.
#pragma once

#include <string>
#include <vector>

#include "scenes/json/text.h"
#include "scenes/keys/keys.h"

namespace isochor::scene_json {

using keys::CurveStart;
using keys::Key;

// What a whole file shares.
struct ReadContext {
  std::string error;
  std::vector<std::string> bodies;  // that keys may name
  // Of these bodies, where there is a world; empty: the n-th name stands for BodyId{n}, and a key that is
  // absent says nothing.
  std::vector<BodyId> ids = {};
  AnalysisType analysis = AnalysisType::statics;

  void fail(const std::string& where, const std::string& message) {
    if (error.empty()) error = where.empty() ? message : where + ": " + message;
  }
};

// The value as it stands in the file, shortened.
std::string shown(const Json& value);
// The word nearest to `word`, as ", did you mean \"...\"?", or nothing when none is near.
std::string suggestion(const std::string& word, const std::vector<std::string>& known);

class Reader final : public keys::Visitor {
 public:
  Reader(const Json& json, std::string place, ReadContext& context)
      : json_(json), place_(std::move(place)), context_(context) {
    if (!json_.is_object()) fail_here("expected an object {...}, found " + shown(json_));
  }

  void about(const char*, const char*) override {}
  void text(const Key& key, std::string& value, const std::string& standard) override;
  void required_text(const Key& key, std::string& value) override;
  void number(const Key& key, double& value, double standard) override;
  void number_or_inf(const Key& key, double& value, double standard) override;
  void optional_number(const Key& key, std::optional<double>& value) override;
  void integer(const Key& key, int& value, int standard) override;
  void flag(const Key& key, bool& value, bool standard) override;
  void vector(const Key& key, Vec3& value, const Vec3& standard) override;
  void required_vector(const Key& key, Vec3& value) override;
  void optional_vector(const Key& key, std::optional<Vec3>& value) override;
  void integers(const Key& key, std::array<int, 3>& value) override;
  void names(const Key& key, std::vector<std::string>& value) override;
  void indices(const Key& key, std::vector<Index>& value) override;
  void numbers(const Key& key, std::vector<double>& value) override;
  void points(const Key& key, std::vector<Vec3>& value) override;
  void paths(const Key& key, std::vector<std::vector<Vec3>>& value) override;
  void boxes(const Key& key, std::vector<std::array<Vec3, 2>>& value) override;
  void optional_box(const Key& key, std::optional<std::array<Vec3, 2>>& value) override;
  void directions(const Key& key, std::vector<Vec3>& value) override;
  void angle(const Key& radians, const Key& degrees, double& value) override;
  void optional_angle(const Key& radians, const Key& degrees, double& value, double standard) override;
  void body(const Key& key, BodyId& value) override;
  void optional_body(const Key& key, std::optional<BodyId>& value) override;
  void curve(const Key& key, Curve& value, CurveStart start, bool matters) override;
  void required_curve(const Key& key, Curve& value, CurveStart start) override;
  void note(const Key& key) override;
  void not_both(const char* a, const char* b) override;
  void mesh_form(std::variant<MeshFile, BoxMeshDef, LatticeMesh>& mesh) override;
  void bodies_known(const std::vector<SceneBody>& bodies) override {
    for (const auto& b : bodies) context_.bodies.push_back(b.name);
  }
  void analysis_known(const AnalysisDef& analysis) override { context_.analysis = analysis.type; }

  // Names the first key that no description asked for.
  void finish();

 protected:
  void choice(const Key& key, int& value, int standard, std::span<const keys::Word> words) override;
  void object_at(const Key& key, const keys::Object& object) override;
  void settings_at(const Key& key, const keys::Object& object) override;
  bool optional_at(const Key& key, const keys::Object& object, bool present) override;
  bool list_at(const Key& key, const keys::List& list, bool present) override;

 private:
  void know(const char* key);
  void read_object(const Json& j, const std::string& where, const keys::Object& object);
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
