#include "scenes/parameters_by_keys.h"

#include <memory>
#include <optional>

#include "engine/base/text.h"
#include "scenes/json/overrides.h"
#include "scenes/json/parse.h"
#include "scenes/json/reader.h"

namespace isochor {

using scene_json::Json;

namespace {

// The texts of a number, without the keys that say nothing about the law or the effect. Where two numbers
// have the same text, the derivative would be zero and be taken for an answer.
class Dependence {
 public:
  Dependence(std::vector<const char*> aside, std::string remedy)
      : aside_(std::move(aside)), remedy_(std::move(remedy)) {}

  Result<std::string> at(const NumberInKeys& number, double value) {
    auto text = number.keys(value);
    if (!text) return text;
    const std::string what = bare(text.value());
    if (!first_) first_.emplace(value, what);
    if (value != first_->first && what == first_->second) {
      return Error{"nothing depends on it: at " + isochor::number(first_->first) + " and at " +
                   isochor::number(value) + " it makes the same; let it use the value" + remedy_};
    }
    return text;
  }

 private:
  std::string bare(const std::string& text) const {
    Json json = Json::parse(text, nullptr, false);
    if (!json.is_object()) return text;
    for (const char* key : aside_) json.erase(key);
    return json.dump();
  }

  std::vector<const char*> aside_;
  std::string remedy_;
  std::optional<std::pair<double, std::string>> first_;
};

}  // namespace

Result<NumberInKeys> number_in_keys(std::string_view json, const std::string& path) {
  auto parsed = scene_json::parse_object(std::string(json), "keys", "what describes it");
  if (!parsed) return parsed.failure();
  const auto whole = std::make_shared<Json>(std::move(parsed).value());
  const auto at = scene_json::value_at(*whole, path, "the keys");
  if (!at) return Error{"key \"" + path + "\": " + at.error()};
  if (!at.value()->is_number()) {
    return Error{"key \"" + path + "\" is " +
                 (at.value()->is_null() ? "not among those that are given" : scene_json::shown(*at.value())) +
                 "; name one that has a number"};
  }
  return NumberInKeys{at.value()->get<double>(), [whole, number = at.value()](double value) {
                        *number = value;
                        return Result<std::string>(whole->dump());
                      }};
}

Parameter material_by_keys(BodyId body, std::string region, NumberInKeys number, std::string folder) {
  const double value = number.value;
  const auto dependence = std::make_shared<Dependence>(
      std::vector{"density", "region"}, ", and take a parameter of kind density for the density");
  return Parameter::material(
      body, std::move(region), value,
      [number = std::move(number), dependence, folder = std::move(folder)](double v) -> Result<MaterialPtr> {
        const auto keys = dependence->at(number, v);
        if (!keys) return keys.failure();
        auto made = material_from_keys(keys.value(), folder);
        if (!made) return made.failure();
        return std::move(made).value().material;
      });
}

Parameter constant_by_keys(EffectId effect, std::string kind, NumberInKeys number, PartContext context) {
  const double value = number.value;
  const auto dependence = std::make_shared<Dependence>(std::vector{"name"}, std::string());
  return Parameter::constant_of(effect, value,
                                [number = std::move(number), dependence, kind = std::move(kind),
                                 context = std::move(context)](double v) -> Result<EffectPtr> {
                                  const auto keys = dependence->at(number, v);
                                  if (!keys) return keys.failure();
                                  return effect_from_keys(kind, keys.value(), context);
                                });
}

}  // namespace isochor
