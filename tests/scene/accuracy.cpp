// The indicator for scenes without a reference, on scenes that have one.
#include "scenes/run/accuracy.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "catch.h"
#include "scenes/library.h"
#include "small_scene.h"

using namespace isochor;

namespace {

// Indicator over true error of the first metric.
double ratio(const SceneDef& scene) {
  const RunResult r = run_scene(scene, {});
  REQUIRE(r.status == RunStatus::converged);
  const Accuracy a = estimate_accuracy(scene, r);
  INFO(a.reason);
  REQUIRE_FALSE(a.entries.empty());
  for (const MetricValue& m : r.metrics) {
    if (m.def.name != a.entries[0].name) continue;
    const double error = std::abs(m.value - *m.def.reference);
    CAPTURE(scene.name, m.def.name, m.value, a.entries[0].indicator, error);
    CHECK(a.entries[0].relative.value() > 0);
    return a.entries[0].indicator / error;
  }
  FAIL("the metric is gone");
  return 0;
}

SceneDef beam(Element element, std::array<int, 3> divisions) {
  SceneVariant v;
  v.element = element;
  SceneDef s = cantilever_tenth(v);
  auto& box = std::get<BoxMeshDef>(s.bodies[0].mesh);
  box.divisions = divisions;
  if (element == Element::hex8) box.cell_type = CellType::hex8;
  // Of the two, the one with the better known reference.
  s.metrics.erase(s.metrics.begin());
  return s;
}

SceneDef panel(Element element, const char* mesh) {
  SceneVariant v;
  v.element = element;
  v.mesh = mesh;
  return cook(v);
}

}  // namespace

TEST_CASE("the indicator is within a factor of three of the true error") {
  const SceneDef scenes[] = {beam(Element::tet4, {10, 1, 1}),
                             beam(Element::tet4, {20, 2, 2}),
                             beam(Element::tet4_edge_smoothed, {20, 2, 2}),
                             beam(Element::tet10, {5, 1, 1}),
                             beam(Element::hex8, {20, 2, 2}),
                             panel(Element::tet4, "cook3d_1"),
                             panel(Element::tet4_edge_smoothed, "cook3d_1"),
                             panel(Element::tet10, "cook3d_coarse_tet10"),
                             panel(Element::hex8, "cook3d_1_hex")};
  for (const SceneDef& scene : scenes) {
    const double r = ratio(scene);
    CHECK(r > 1.0 / 3);
    CHECK(r < 3);
  }
}

TEST_CASE("Tet10 on a mesh of Tet4 has an upper limit, on one of Tet10 a finer mesh") {
  const SceneDef on_tet4 = panel(Element::tet10, "cook3d_1");
  const auto limit = compared_scene(on_tet4);
  REQUIRE(limit.ok());
  CHECK(limit.value().comparison == Comparison::worse_element);
  CHECK(ratio(on_tet4) > 1);
  const auto finer = compared_scene(panel(Element::tet10, "cook3d_1_tet10"));
  REQUIRE(finer.ok());
  CHECK(finer.value().comparison == Comparison::finer_mesh);
  CHECK(finer.value().scene.bodies[0].refine == 1);
}

TEST_CASE("scenes without anything better, or without an answer, have a reason") {
  const auto lattice = compared_scene(finger_lattice({}));
  REQUIRE_FALSE(lattice.ok());
  CHECK_THAT(lattice.error(), ContainsSubstring("no indicator") && ContainsSubstring("spacing"));
  RunResult failed;
  failed.status = RunStatus::not_converged;
  const Accuracy a = estimate_accuracy(test::small_scene(), failed);
  CHECK_THAT(a.reason, Catch::Matchers::Contains("did not converge"));
  const auto j = nlohmann::json::parse(summary_json(failed, a));
  CHECK(j["accuracy"]["reason"] == a.reason);
  CHECK(j["accuracy"]["indicators"].empty());
}

TEST_CASE("indicators cover metrics and probes, not residuals") {
  SceneDef scene = test::small_scene();
  MetricDef residual;
  residual.name = "volume error";
  residual.quantity = Quantity::volume_row_residual;
  scene.metrics.push_back(residual);
  const RunResult r = run_scene(scene, {});
  const Accuracy a = estimate_accuracy(scene, r);
  REQUIRE(a.entries.size() == 2);
  CHECK(a.entries[0].name == "pulled");
  CHECK(a.entries[1].name == "probe tip");
  CHECK(a.entries[0].indicator == Approx(std::abs(a.entries[0].value - a.entries[0].other)));
  const auto j = nlohmann::json::parse(summary_json(r, a));
  CHECK(j["accuracy"]["indicators"].size() == 2);
  CHECK(j["accuracy"]["upper_limit"] == false);
  CHECK(j["status"] == "converged");
}

TEST_CASE("components of a displacement are held against a tenth of it at least, at the time of the metric") {
  SceneDef scene = test::small_scene({"bodies[0].mesh.box.divisions=[6, 3, 3]", "analysis.steps=2"});
  for (const std::optional<double> time : {std::optional<double>{}, {0.5}}) {
    for (const Component c : {Component::x, Component::y, Component::z, Component::magnitude}) {
      MetricDef m;
      m.name = "along " + std::to_string(scene.metrics.size());
      m.of = scene.probes.at(0).name;
      m.component = c;
      m.scale = -1e3;
      m.time = time;
      scene.metrics.push_back(m);
    }
  }
  const RunResult r = run_scene(scene, {});
  REQUIRE(r.status == RunStatus::converged);
  const auto answers = answers_of(r);
  REQUIRE(answers.size() == 10);
  int small = 0;
  for (const std::size_t first : {1, 5}) {
    const double whole = answers[first + 3].size;
    CHECK(whole > 0);
    const Vec3& u = r.records.at(first == 1 ? 2 : 1).probes.at(0);
    CHECK(whole == Approx(1e3 * std::hypot(u.x, u.y, u.z)));
    for (std::size_t c = 0; c < 3; ++c) {
      const double own = std::abs(answers[first + c].value.x);
      CHECK(answers[first + c].size == Approx(std::max(own, 0.1 * whole)));
      small += own < 0.1 * whole ? 1 : 0;
    }
  }
  CHECK(small > 0);
}

TEST_CASE("every answer of an equilibrium says where its error comes from") {
  const SceneDef scene = test::small_scene();
  RunOptions options;
  options.origins = true;
  const RunResult r = run_scene(scene, options);
  REQUIRE(r.status == RunStatus::converged);
  const auto answers = answers_of(r);
  REQUIRE(answers.size() == 2);
  REQUIRE(r.origins.size() == answers.size());
  for (std::size_t k = 0; k < answers.size(); ++k) {
    CAPTURE(answers[k].name);
    CHECK(r.origins[k].name == answers[k].name);
    CHECK(r.origins[k].by_output);
    CHECK_THAT(r.origins[k].where, ContainsSubstring(answers[k].name + ": three quarters of its error"));
    double sum = 0;
    for (const double share : r.origins[k].cells.at(0)) sum += share;
    CHECK(sum == Approx(1));
  }
  CHECK(run_scene(scene, {}).state_hash == r.state_hash);
  const Accuracy a = estimate_accuracy(scene, r);
  for (const AccuracyEntry& e : a.entries) CHECK_FALSE(e.where.empty());
}
