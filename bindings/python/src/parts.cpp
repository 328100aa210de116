#include "parts.h"

#include <nlohmann/json.hpp>

#include "isochor/schemes.h"
#include "scenes/effects/kind.h"
#include "scenes/scene_file.h"

namespace isochor::python {

using Json = nlohmann::ordered_json;

namespace {

Json dummy(const std::string& name) {
  return {{"name", name}, {"mesh", {{"box", Json::object()}}}, {"materials", Json::array({{{"young", 1}}})}};
}
SceneDef scene_of(const Json& json) {
  return need(parse_scene(json.dump(), "", "", {}));
}

}  // namespace

OptionParts options_from(const std::string& keys) {
  Json given = Json::parse(keys);
  const std::string scheme = given.value("scheme", "implicit_euler");
  const bool statics = scheme == "statics" || scheme == "continuation";
  const int threads = given.value("threads", 0);
  Json scene{{"bodies", Json::array({dummy("body")})}};
  if (given.contains("gravity")) scene["gravity"] = given["gravity"];
  given.erase("gravity");
  given.erase("threads");
  if (statics) given.erase("scheme");
  given["type"] = statics ? "static" : "dynamic";
  scene["analysis"] = given;
  const SceneDef def = scene_of(scene);
  OptionParts out{def.analysis.options, statics};
  out.options.threads = threads;
  const auto& a = def.analysis;
  if (statics)
    out.options.scheme = scheme == "statics" ? isochor::statics() : continuation();
  else if (a.scheme == SchemeWord::implicit_euler)
    out.options.scheme = implicit_euler();
  else if (a.scheme == SchemeWord::bdf2)
    out.options.scheme = bdf2();
  else if (a.scheme == SchemeWord::generalized_alpha)
    out.options.scheme = generalized_alpha(a.spectral_radius);
  else if (a.scheme == SchemeWord::newmark)
    out.options.scheme = newmark();
  else
    out.options.scheme = implicit_midpoint();
  return out;
}

BodyDef body_from(const std::string& keys, const Mesh& mesh) {
  Json given = Json::parse(keys);
  given["mesh"] = {{"box", Json::object()}};
  const SceneDef scene = scene_of({{"bodies", Json::array({given})}});
  const SceneBody& body = scene.bodies.front();
  BodyDef def;
  def.name = body.name;
  def.mesh = mesh;
  def.element = body.element;
  def.guard_stiffness = body.guard_stiffness;
  def.guard_threshold = body.guard_threshold;
  for (const MaterialDef& m : body.materials)
    def.materials.push_back({m.region, need(make_material(m, "")), m.density});
  return def;
}

MaterialPtr material_from(const std::string& keys) {
  Json body = dummy("body");
  body["materials"] = Json::array({Json::parse(keys)});
  const SceneDef scene = scene_of({{"bodies", Json::array({body})}});
  return need(make_material(scene.bodies.front().materials.front(), ""));
}

Selection selection_from(const std::string& keys, const PartNames& names) {
  Json bodies = Json::array();
  for (const std::string& name : names.bodies) bodies.push_back(dummy(name));
  const SceneDef scene = scene_of(
      {{"bodies", bodies}, {"orientations", Json::array({{{"name", "one"}, {"where", Json::parse(keys)}}})}});
  return scene.orientations.front().where;
}

EffectPtr effect_from(const std::string& list, const std::string& keys, const PartNames& names) {
  Json bodies = Json::array();
  for (const std::string& name : names.bodies) bodies.push_back(dummy(name));
  Json scene{{"bodies", bodies}, {"analysis", {{"type", names.statics ? "static" : "dynamic"}}}};
  scene[list] = Json::array({Json::parse(keys)});
  const SceneDef def = scene_of(scene);
  WorldOptions options;
  options.scheme = implicit_euler();
  BuiltScene built{need(World::create(options))};
  SceneParts parts;
  EffectAdder adder(def, &parts, built);
  for (const EffectKind* kind : effect_kinds) {
    if (kind->key == list) need(kind->add(*kind, adder));
  }
  return parts.effects.back();
}

}  // namespace isochor::python
