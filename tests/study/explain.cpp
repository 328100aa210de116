// `run --explain`: everything that is on is named, and its parts add up to the whole.
#include "scenes/explain.h"

#include <algorithm>

#include "catch.h"
#include "scenes/library.h"

using namespace isochor;

namespace {

bool names(const Explanation& e, const std::string& effect) {
  return std::any_of(e.effects.begin(), e.effects.end(),
                     [&](const EffectNote& n) { return n.effect.find(effect) != std::string::npos; });
}

Explanation explained(const SceneDef& scene) {
  auto e = explain(scene);
  INFO((e ? std::string() : e.error()));
  REQUIRE(e.ok());
  return std::move(e).value();
}

}  // namespace

TEST_CASE("an explanation names what is on and adds up") {
  SceneVariant variant;
  variant.mesh = "finger_small";
  SceneDef scene = finger(variant);
  const Explanation e = explained(scene);
  for (const char* effect :
       {"body \"", "volume rows", "element guard", "support \"clamp\"", "cavity \"chamber\""}) {
    INFO(effect);
    CHECK(names(e, effect));
  }
  CHECK_FALSE(names(e, "inertia"));
  CHECK_FALSE(names(e, "gravity"));
  auto built = build(scene);
  REQUIRE(built.ok());
  const WorldSize size = built.value().world.size();
  CHECK(e.displacements == size.displacement_unknowns);
  CHECK(e.multipliers == size.multipliers);
  CHECK(e.displacements + e.held == 3 * size.nodes);
  Index rows = 0, given = 0;
  for (const PoolShare& p : e.pools) {
    rows += p.multipliers;
    given += p.prescribed;
    CHECK(p.stencils > 0);
    CHECK(p.bytes > 0);
    CHECK(p.seconds > 0);
  }
  CHECK(rows == size.multipliers);
  CHECK(given == 1);  // the pressure of the chamber
}

TEST_CASE("what is switched off is not in an explanation") {
  SceneVariant variant;
  variant.mesh = "finger_small";
  SceneDef scene = finger(variant);
  for (auto& m : scene.bodies[0].materials) m.constants.poisson = 0.4;
  scene.bodies[0].guard_stiffness = 0;
  scene.cavities.clear();
  std::erase_if(scene.metrics, [](const MetricDef& m) { return m.quantity == Quantity::cavity_volume; });
  scene.volumes = std::vector<VolumeRows>(1);
  scene.volumes->front().none = true;
  const Explanation e = explained(scene);
  CHECK_FALSE(names(e, "cavity"));
  CHECK_FALSE(names(e, "element guard"));
  CHECK(names(e, "no volume rows"));
  CHECK(e.multipliers == 0);
  scene.analysis.options.gravity = {0, -1, 0};
  scene.analysis.type = AnalysisType::dynamics;
  CHECK(names(explained(scene), "inertia"));
  CHECK(names(explained(scene), "gravity"));
}

TEST_CASE("a scene that cannot be built cannot be explained") {
  SceneDef scene = finger({});
  scene.bodies[0].mesh = MeshFile{"meshes/nosuch.msh", 1};
  CHECK_FALSE(explain(scene).ok());
}
