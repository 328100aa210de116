#include "parts.h"

#include <nlohmann/json.hpp>

namespace isochor::python {

PartContext KeyMeaning::in(const World& world) const {
  PartContext context;
  for (const BodyId body : world.bodies()) context.bodies.emplace_back(world.body_name(body), body);
  for (const EffectId effect : world.effects()) context.names_taken.push_back(world.effect_name(effect));
  context.analysis = analysis;
  context.gravity = gravity;
  context.gravity_curve = gravity_curve;
  return context;
}

WorldOptions options_from(const std::string& keys, KeyMeaning& meaning) {
  nlohmann::ordered_json given = nlohmann::ordered_json::parse(keys);
  const auto scheme = given.find("scheme");
  if (scheme != given.end() && (*scheme == "statics" || *scheme == "continuation")) {
    if (*scheme == "continuation") given["follow"] = true;
    given["type"] = "static";
    given.erase("scheme");
    meaning.analysis = AnalysisType::statics;
  }
  WorldOptions options = need(options_from_keys(given.dump()));
  meaning.gravity = options.gravity;
  meaning.gravity_curve = options.gravity_curve;
  return options;
}

}  // namespace isochor::python
