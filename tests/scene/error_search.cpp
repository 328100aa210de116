// An error that is asked for: found, delivered, or refused with a reason.
#include "scenes/run/error_search.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "catch.h"
#include "scenes/library.h"
#include "scenes/run/error_forecast.h"
#include "scenes/run/machine_cost.h"
#include "scenes/run/price.h"
#include "scenes/run/step_errors.h"
#include "small_scene.h"

using namespace isochor;

namespace {

SceneDef beam() {
  SceneDef s = cantilever_tenth({});
  std::get<BoxMeshDef>(s.bodies[0].mesh).divisions = {10, 1, 1};
  s.metrics.erase(s.metrics.begin());  // of the two, the one with the better known reference
  return s;
}

SceneDef on_mesh(SceneDef (*make)(const SceneVariant&), const char* mesh,
                 std::optional<Element> element = Element::tet4_edge_smoothed) {
  SceneVariant v;
  v.mesh = mesh;
  v.element = element;
  return make(v);
}

// The largest relative error of the metrics that have a reference.
double true_error(const RunResult& r) {
  double worst = 0;
  for (const MetricValue& m : r.metrics) {
    if (!m.def.reference || *m.def.reference == 0) continue;
    worst = std::max(worst, std::abs(m.value / *m.def.reference - 1));
  }
  return worst;
}

ErrorSearch search(const SceneDef& scene, double error) {
  ErrorSearchOptions options;
  options.error = error;
  return search_error(scene, options);
}

std::vector<Answer> answers(std::initializer_list<double> values) {
  std::vector<Answer> out;
  for (const double v : values) {
    Answer a;
    a.name = std::string("m").append(std::to_string(out.size()));
    a.value.x = v;
    a.size = std::abs(v);
    out.push_back(a);
  }
  return out;
}

}  // namespace

TEST_CASE("the error that is asked for is delivered, on scenes with a reference") {
  struct Case {
    SceneDef scene;
    double error;
  };
  const Case cases[] = {{beam(), 0.03},
                        {on_mesh(cook, "cook3d_1"), 0.03},
                        {on_mesh(cook_plane, "cook_plane_grid_1"), 0.02},
                        {on_mesh(thick_tube, "thick_tube_coarse"), 0.03},
                        {on_mesh(torsion, "torsion_cylinder_1"), 0.03}};
  for (const Case& c : cases) {
    const ErrorSearch s = search(c.scene, c.error);
    CAPTURE(c.scene.name, s.sentence, s.trials.size(), true_error(s.result));
    REQUIRE(s.end == SearchEnd::reached);
    CHECK(true_error(s.result) < 1.5 * c.error);
    CHECK(*s.trials[*s.best].indicator <= c.error);
  }
}

TEST_CASE("a search repeats to the bit, and its best run stands alone") {
  const SceneDef scene = test::small_scene();
  const test::Scratch folder("search");
  ErrorSearchOptions options;
  options.error = 0.02;
  options.run.folder = folder / "out";
  const ErrorSearch a = search_error(scene, options), b = search_error(scene, options);
  REQUIRE(a.end == SearchEnd::reached);
  CHECK(a.result.state_hash == b.result.state_hash);
  REQUIRE(a.trials.size() == b.trials.size());
  for (std::size_t k = 0; k < a.trials.size(); ++k) {
    CHECK(a.trials[k].setting == b.trials[k].setting);
    CHECK(a.trials[k].indicator == b.trials[k].indicator);
  }
  CHECK(run_scene(a.scene, {}).state_hash == a.result.state_hash);
  // The outputs are those of the best, and nothing else is left.
  const auto j = nlohmann::json::parse(test::slurp(folder / "out/summary.json"));
  CHECK(j["accuracy"]["error_asked"] == 0.02);
  CHECK(j["accuracy"]["search"] == "reached");
  CHECK(j["accuracy"]["trials"].size() == a.trials.size());
  CHECK(j["accuracy"]["overrides"] == a.overrides);
  CHECK(j["unknowns"]["displacement"] == a.result.size.displacement_unknowns);
  CHECK(std::filesystem::exists(folder / "out/frames/small_00003.vtu"));
  CHECK(std::filesystem::exists(folder / "out/small.pvd"));
  CHECK_FALSE(std::filesystem::exists(folder / "out/.trial"));
}

TEST_CASE("a search that does not get there says what holds it up") {
  ErrorSearchOptions options;
  options.error = 1e-5;
  options.most_levels = 1;
  const ErrorSearch s = search_error(test::small_scene(), options);
  CHECK(s.end == SearchEnd::not_reached);
  REQUIRE(s.best);
  CHECK_THAT(s.sentence, ContainsSubstring("0.001 % not reached") && ContainsSubstring("held by \"") &&
                             ContainsSubstring("no more is tried"));
  CHECK(s.accuracy.entries.size() == 2);

  options.run.budget = 1e-6;
  const ErrorSearch late = search_error(test::small_scene(), options);
  CHECK(late.end == SearchEnd::budget);
  CHECK_FALSE(late.best);
}

TEST_CASE("a search that is stopped keeps the best so far") {
  const test::Scratch folder("stopped_search");
  ErrorSearchOptions options;
  options.error = 1e-5;
  options.run.folder = folder / "out";
  bool stop = false;
  options.run.stop = [&] { return stop; };
  options.on_trial = [&](const Trial&) { stop = true; };
  const ErrorSearch s = search_error(test::small_scene(), options);
  CHECK(s.end == SearchEnd::interrupted);
  REQUIRE(s.best);
  const auto j = nlohmann::json::parse(test::slurp(folder / "out/summary.json"));
  CHECK(j["status"] == "converged");
  CHECK(j["accuracy"]["search"] == "interrupted");
  CHECK_FALSE(std::filesystem::exists(folder / "out/.trial"));
}

TEST_CASE("demands without a meaning are refused") {
  for (const char* text :
       {"0", "0%", "-1%", "nan", "inf", "100%", "1", "", "%", "1%%", "one", "1e400", "1 % x"}) {
    INFO(text);
    const auto r = parse_error_demand(text);
    REQUIRE_FALSE(r.ok());
    CHECK_THAT(r.error(), ContainsSubstring(text) && ContainsSubstring("above 0 %"));
  }
  CHECK(parse_error_demand("1%").value() == Approx(0.01));
  CHECK(parse_error_demand("0.3 %").value() == Approx(0.003));
  CHECK(parse_error_demand("0.01").value() == Approx(0.01));

  SceneDef scene = test::small_scene();
  for (const double error : {0.0, -0.1, 1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    const ErrorSearch s = search(scene, error);
    CHECK(s.end == SearchEnd::bad_input);
    CHECK_THAT(s.sentence, ContainsSubstring("above 0"));
  }
  scene.probes.clear();
  scene.metrics.clear();
  CHECK_THAT(search(scene, 0.01).sentence, ContainsSubstring("no probe and no metric"));
  CHECK_THAT(search(finger_lattice({}), 0.01).sentence,
             ContainsSubstring("lattice") && ContainsSubstring("cannot be refined"));
  SceneDef wrong = test::small_scene();
  wrong.metrics[0].of = "nobody";
  CHECK_THAT(search(wrong, 0.01).sentence, ContainsSubstring("nobody"));
}

TEST_CASE("bodies whose cells leave no choice are refined alone") {
  SceneVariant v;
  v.mesh = "thick_tube_coarse_hex";
  v.element = Element::hex8;
  const ErrorSearch s = search(thick_tube(v), 0.05);
  CAPTURE(s.sentence);
  CHECK(s.end == SearchEnd::reached);
  CHECK_FALSE(s.trials[0].setting.element.has_value());
  CHECK_THAT(s.overrides, ContainsSubstring("bodies[0].refine="));
  CHECK_THAT(s.overrides, !ContainsSubstring("element"));
}

TEST_CASE("evidence bounds errors of known order") {
  for (const double order : {1.0, 1.5, 2.0, 3.0}) {
    CAPTURE(order);
    const auto at_level = [&](int level) { return answers({1 + 0.1 * std::pow(2, -order * level)}); };
    const double error = 0.1 * std::pow(2, -2 * order), coarse = 0.1 * std::pow(2, -order);
    CHECK(from_two_meshes(at_level(0), at_level(1)).largest >= 0.99 * coarse / (1 + coarse));
    const Evidence three = from_three_meshes(at_level(0), at_level(1), at_level(2));
    CHECK(three.entries[0].indicator >= error);
    CHECK(three.entries[0].indicator <= 3 * error * std::max(1.0, std::pow(2, order - 2)));
  }
  // Differences of both signs, or growing ones, tell of no order.
  CHECK(from_three_meshes(answers({1.0}), answers({1.2}), answers({1.1})).entries[0].indicator ==
        Approx(0.2));
  CHECK(from_three_meshes(answers({1.0}), answers({1.1}), answers({1.3})).entries[0].indicator ==
        Approx(0.2));
  CHECK(from_three_meshes(answers({1.0}), answers({1.0}), answers({1.0})).largest == 0);
  CHECK(from_two_elements(answers({1.0}), answers({1.1}), "Tet4").entries[0].indicator == Approx(0.15));
  // The worst decides, and rounding beside numbers of the same unit is none.
  const Evidence two = from_two_meshes(answers({1.0, 2.0, 1e-17}), answers({1.01, 2.2, -1e-17}));
  CHECK(two.held_by == "m1");
  CHECK(two.largest == Approx(0.2 / 2.2));
  // A metric that one run did not reach leaves the error open.
  CHECK(std::isinf(from_two_meshes(answers({1.0}), answers({1.0, 2.0})).largest));
}

TEST_CASE("a price names element, mesh, time and memory, cheaper for larger errors") {
  const Price p = price_of(test::small_scene(), {});
  CHECK(p.reason.empty());
  REQUIRE(p.rows.size() == 4);
  CHECK(p.trials.size() == 3);
  for (std::size_t k = 0; k < p.rows.size(); ++k) {
    REQUIRE(p.rows[k].setting.has_value());
    CHECK(p.rows[k].cost.unknowns > 0);
    CHECK(p.rows[k].cost.bytes() > 0);
    CHECK(p.rows[k].cost.seconds() > 0);
    if (k > 0) CHECK(p.rows[k].search_s >= p.rows[k - 1].search_s);
  }
  SceneDef nothing = test::small_scene();
  nothing.probes.clear();
  nothing.metrics.clear();
  CHECK_THAT(price_of(nothing, {}).reason, ContainsSubstring("has no price"));
}

TEST_CASE("costs grow by what is counted, and a damaged cache of them is none") {
  CostModel model;
  RunCost cost;
  cost.factor_s = 1;
  cost.other_s = 2;
  cost.factor_bytes = 3;
  cost.other_bytes = 4;
  cost.unknowns = 5;
  const RunCost finer = model.refined(cost, Element::tet10, 2);
  CHECK(finer.unknowns == Approx(5 * 64));
  CHECK(finer.other_s == Approx(2 * 64));
  CHECK(finer.factor_bytes == Approx(3 * std::pow(model.of(Element::tet10).entries_growth, 2)));
  const RunCost there = model.with_element(cost, Element::tet4, Element::tet10);
  CHECK(model.with_element(there, Element::tet10, Element::tet4).seconds() == Approx(cost.seconds()));

  model.of(Element::tet10).seconds_power = 1.25;
  const std::string text = to_text(model, 2);
  const auto back = cost_model_from_text(text, 2);
  REQUIRE(back.has_value());
  CHECK(back->of(Element::tet10).seconds_power == 1.25);
  CHECK_FALSE(cost_model_from_text(text, 1).has_value());
  for (std::size_t size = 0; size + 2 < text.size(); size += 7)
    CHECK_FALSE(cost_model_from_text(text.substr(0, size), 2));
  for (const char* other : {"", "[]", "{}", "null", "{\"format\": 1}", "\xff\xfe"})
    CHECK_FALSE(cost_model_from_text(other, 2));
  auto j = nlohmann::json::parse(text);
  j["elements"][0][0] = -1;
  CHECK_FALSE(cost_model_from_text(j.dump(), 2));
  j["elements"][0][0] = "15";
  CHECK_FALSE(cost_model_from_text(j.dump(), 2));
}

namespace {

// Falls freely while gravity grows as g t: n steps of implicit Euler of length h fall by g h^3 n (n + 1) (n +
// 2) / 6, whatever the mesh.
SceneDef falling_block(double step) {
  SceneDef s = test::small_scene();
  s.dirichlet.clear();
  s.tractions.clear();
  s.analysis.type = AnalysisType::dynamics;
  s.analysis.options.gravity = {-9.81, 0, 0};
  s.analysis.duration = 0.12;
  s.analysis.step = step;
  return s;
}

}  // namespace

TEST_CASE("steps are cut until their part of the error is small, and no more than that") {
  for (const double step : {0.03, 0.012, 0.004}) {
    const ErrorSearch s = search(falling_block(step), 0.02);
    CAPTURE(step, s.sentence);
    REQUIRE(s.end == SearchEnd::reached);
    const double h = step / (1 << s.trials[*s.best].setting.halved), t = 0.12;
    const double error = std::abs(s.result.metrics[0].value) / (9.81 * t * t * t / 6) - 1;
    CHECK(error == Approx((1 + h / t) * (1 + 2 * h / t) - 1).epsilon(1e-3));
    CHECK(error < 0.4 * 0.02);
    CHECK(2.2 * error > 0.4 * 0.02);  // with steps of twice the length it would not be
    // The estimate is that error and little more: meshes play no part.
    CHECK(*s.trials[*s.best].indicator >= 0.9 * error);
    CHECK(*s.trials[*s.best].indicator <= 2 * error);
    CHECK_THAT(s.overrides, ContainsSubstring("analysis.step="));
    CHECK(run_scene(s.scene, {}).state_hash == s.result.state_hash);
  }
}

TEST_CASE("steps that cannot be cut enough are named, and what the answer is worth with them") {
  const ErrorSearch s = search(falling_block(0.12), 1e-5);
  CHECK(s.end == SearchEnd::not_reached);
  CHECK_THAT(s.sentence,
             ContainsSubstring("shorter steps") && ContainsSubstring("256") && ContainsSubstring("bdf2"));
  REQUIRE(s.best);
  CHECK(*s.trials[*s.best].indicator > 0.05);
}

TEST_CASE("steps are looked at where they have a part in the answer alone") {
  SceneDef scene = test::small_scene();
  CHECK_FALSE(steps_matter(scene));
  for (const Trial& t : search(scene, 0.05).trials) CHECK_FALSE(t.of_steps.has_value());
  SceneDef rubs = scene;
  rubs.contacts.emplace_back();
  CHECK_FALSE(steps_matter(rubs));
  rubs.contacts[0].friction = 0.1;
  CHECK(steps_matter(rubs));
  scene.bodies[0].materials[0].prony = {{0.5, 1}};
  CHECK_FALSE(steps_matter(scene));
  scene.bodies[0].materials[0].static_time = StaticTime::seconds;
  CHECK(steps_matter(scene));
  CHECK(steps_matter(falling_block(0.01)));
}

TEST_CASE("errors of steps are bounded where they are of first and second order") {
  for (const double order : {1.0, 2.0}) {
    StepErrors steps;
    for (int k = 0; k < 4; ++k) steps.add(answers({1 + 0.1 * std::pow(2, -order * k)}));
    for (int k = 0; k < 4; ++k) {
      CAPTURE(order, k);
      const double error = 0.1 * std::pow(2, -order * k);
      CHECK(steps.evidence(k).entries[0].indicator >= 0.999 * error);
      CHECK(steps.evidence(k).entries[0].indicator <= 2 * error);
    }
    CHECK(steps.within(0.2) == 0);
    CHECK_FALSE(steps.within(1e-6));
  }
  // Mesh and steps that add up leave nothing over; what they do together is told.
  CHECK(from_interplay(answers({2.0}), answers({1.0}), answers({1.25}), answers({2.25})).largest == 0);
  CHECK(from_interplay(answers({2.0}), answers({1.0}), answers({1.25}), answers({2.5})).largest ==
        Approx(0.1));
  CHECK(together(from_two_meshes(answers({1.0}), answers({2.0})), Evidence{}).largest ==
        std::numeric_limits<double>::infinity());
}
