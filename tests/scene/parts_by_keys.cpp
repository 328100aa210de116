// Parts of a world from keys: the same as in a scene file, with messages of the same form.
#include "scenes/parts_by_keys.h"

#include "catch.h"
#include "isochor/schemes.h"
#include "small_scene.h"

using namespace isochor;
using Catch::Matchers::Contains;

namespace {

constexpr const char* kBody =
    R"({"name": "block", "mesh": {"box": {"upper": [2, 1, 1], "divisions": [2, 1, 1]}},
        "materials": [{"young": 1000, "poisson": 0.5}]})";

template <class T>
T need(Result<T> result) {
  INFO((result ? std::string() : result.error()));
  REQUIRE(result);
  return std::move(result).value();
}

template <class T>
std::string why(const Result<T>& result) {
  return result ? std::string("(none)") : result.error();
}

struct Hosted {
  World world;
  PartContext context;

  explicit Hosted(const char* options) : world(make(options)) {}
  static World make(const char* options) { return need(World::create(need(options_from_keys(options)))); }

  BodyId body(const char* keys) {
    BodyDef def = need(body_from_keys(keys, ""));
    const std::string name = def.name;
    const BodyId id = need(world.add_body(std::move(def)));
    context.bodies.emplace_back(name, id);
    return id;
  }
  EffectId effect(const char* kind, const char* keys) {
    const EffectId id = need(world.add(need(effect_from_keys(kind, keys, context))));
    context.names_taken.push_back(world.effect_name(id));
    return id;
  }
};

}  // namespace

TEST_CASE("a world of parts by keys has the bits of the scene file that says the same") {
  Hosted hosted(R"({"type": "static"})");
  hosted.context.analysis = AnalysisType::statics;
  hosted.body(kBody);
  hosted.effect("volume", "{}");
  hosted.effect("dirichlet", R"({"name": "wall", "where": {"surfaces": "x0"}})");
  hosted.effect("tractions", R"({"name": "pull", "surface": "x1", "traction": [100, 0, 0]})");
  BuiltScene built = need(build(test::small_scene()));
  for (int i = 0; i < 3; ++i) {
    REQUIRE(hosted.world.advance(1.0 / 3).status == StepStatus::converged);
    REQUIRE(built.world.advance(1.0 / 3).status == StepStatus::converged);
  }
  CHECK(hosted.world.state_hash() == built.world.state_hash());
}

TEST_CASE("every kind of effect of scene files is known by word and by list") {
  const PartContext nobody;
  CHECK(effect_kinds_known().size() == std::size(effect_kinds));
  for (const std::string& word : effect_kinds_known()) {
    INFO(word);
    CHECK_THAT(why(effect_from_keys(word, R"({"nonsense": 1})", nobody)), Contains(word));
  }
  CHECK_THAT(why(effect_from_keys("cavty", "{}", nobody)),
             Contains("\"cavty\" is no kind of effect") && Contains("did you mean \"cavity\"?"));
}

TEST_CASE("effects by keys name bodies by the ids of their world") {
  Hosted one("{}"), other("{}");
  one.body(kBody);
  other.body(kBody);
  one.effect("volume", "{}");
  other.effect("volume", "{}");
  const EffectPtr support =
      need(effect_from_keys("dirichlet", R"({"where": {"body": "block", "surfaces": "x0"}})", one.context));
  (void)need(other.world.add(support));
  CHECK_THAT(why(other.world.compile()), Contains("another world"));
  (void)need(one.world.add(support));
  CHECK_THAT(why(one.world.compile()), Contains("(none)"));
}

TEST_CASE("what is wrong with the keys of a part is said with its place") {
  Hosted hosted("{}");
  hosted.body(kBody);
  const auto effect = [&](const char* kind, const char* keys) {
    return why(effect_from_keys(kind, keys, hosted.context));
  };
  CHECK_THAT(effect("cavity", R"({"name": "c", "surfaces": "x0"})"),
             Contains("cavity: \"amount\" is missing"));
  CHECK_THAT(effect("cavity", R"({"name": "c", "surfaces": "x0", "amount": 1, "amont": 1})"),
             Contains("cavity.amont: unknown key") && Contains("\"amount\""));
  CHECK_THAT(effect("dirichlet", R"({"where": {"body": "blok"}})"),
             Contains("dirichlet.where.body") && Contains("\"block\""));
  CHECK_THAT(effect("volume", R"({"space": "none"})"), Contains("volume") && Contains("no effect"));
  CHECK_THAT(effect("volume", "[]"), Contains("volume: what describes it is one object"));
  CHECK_THAT(effect("volume", "{\"name\":"), Contains("volume: ") && Contains("line 1"));
  CHECK_THAT(why(material_from_keys(R"({"young": -1})", "")), Contains("material") && Contains("young"));
  CHECK_THAT(why(body_from_keys(R"({"name": "b"})", "")), Contains("body: \"mesh\" is missing"));
  CHECK_THAT(why(body_from_keys(R"({"mesh": {"box": {}}})", "")), Contains("materials"));
  CHECK_THAT(why(options_from_keys(R"({"steps": 3})")), Contains("options.steps"));
  CHECK_THAT(why(options_from_keys(R"({"type": "static", "scheme": "bdf2"})")), Contains("options.scheme"));
  CHECK_THAT(why(selection_from_keys(R"({"surfaces": 3})", hosted.context)), Contains("where.surfaces"));
}

TEST_CASE("effects without a name get one that is free") {
  Hosted hosted("{}");
  hosted.body(kBody);
  const EffectId first = hosted.effect("dirichlet", R"({"where": {"surfaces": "x0"}})");
  const EffectId second = hosted.effect("dirichlet", R"({"where": {"surfaces": "x1"}})");
  CHECK_FALSE(hosted.world.effect_name(first).empty());
  CHECK(hosted.world.effect_name(second) == hosted.world.effect_name(first) + " 2");
}

TEST_CASE("a body by keys takes a mesh that is given in memory") {
  const Mesh mesh = need(box_mesh({}));
  const BodyDef body =
      need(body_from_keys(R"({"name": "given", "materials": [{"young": 5, "density": 7}]})", "", &mesh));
  CHECK(body.name == "given");
  CHECK(body.mesh.nodes.size() == 8);
  CHECK(body.materials.front().density == 7);
  CHECK_THAT(why(body_from_keys(kBody, "", &mesh)), Contains("body.mesh"));
}

TEST_CASE("plain numbers for curves ramp in statics and hold in dynamics") {
  Hosted hosted("{}");
  hosted.body(kBody);
  const auto traction = R"({"name": "pull", "surface": "x1", "traction": [100, 0, 0], "amount": 1})";
  const auto force_after_a_moment = [&](AnalysisType type) {
    Hosted one(type == AnalysisType::statics ? R"({"type": "static"})" : "{}");
    one.context.analysis = type;
    one.body(kBody);
    one.effect("volume", "{}");
    const EffectId wall = one.effect("dirichlet", R"({"name": "wall", "where": {"surfaces": "x0"}})");
    one.effect("traction", traction);
    REQUIRE(one.world.step(0.25).status == StepStatus::converged);
    return one.world.reaction(wall)[0].x;
  };
  CHECK(force_after_a_moment(AnalysisType::statics) == Approx(-25).epsilon(1e-6));
}

TEST_CASE("what there is to say is told as JSON") {
  CHECK_THAT(effect_keys_json(), Contains("\"cavity\"") && Contains("\"polytropic\""));
  CHECK_THAT(part_keys_json(), Contains("\"material\"") && Contains("\"young\"") && Contains("\"threads\""));
}
