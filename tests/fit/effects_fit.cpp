// Constants of effects in scenes: springs, cables, fabric, contact, friction, chambers.
#include <cmath>
#include <random>

#include "catch.h"
#include "scenes/scene_file.h"
#include "studies/fit/scene_fit.h"
#include "studies/inverse/data_report.h"
#include "support/worlds.h"

using namespace isochor;
using namespace isochor::fit;
using Catch::Matchers::Contains;
using Catch::Matchers::WithinRel;
using test::value;

namespace {

// A bar on a wall with a spring at its end, a cable along its top and fabric on its front.
SceneDef bar(const Overrides& overrides = {}) {
  return value(parse_scene(R"({
    "bodies": [{"name": "bar", "element": "tet4",
                "mesh": {"box": {"upper": [0.3, 0.1, 0.1], "divisions": [3, 1, 1]}},
                "materials": [{"young": 50000, "poisson": 0.45, "density": 1000}]}],
    "analysis": {"steps": 2},
    "dirichlet": [{"name": "wall", "where": {"surfaces": "x0"}}],
    "tractions": [{"name": "pull", "surface": "x1", "traction": [2000, 300, -500]}],
    "springs": [{"name": "hold", "from": [0.3, 0.1, 0.1], "to": [0.3, 0.1, 0.5], "stiffness": 40}],
    "cables": [{"name": "rope", "points": [[0.1, 0.05, 0.1], [0.3, 0.05, 0.1]], "amount": [[0, 1], [1, 0.97]],
                "stiffness": 900}],
    "layers": [{"name": "cloth", "surfaces": "y0", "stiffness": 700}],
    "gravity": [0, 0, -9.81],
    "probes": [{"name": "tip", "point": [0.3, 0.05, 0.05]}, {"name": "top", "point": [0.2, 0.1, 0.1]}]
  })",
                           "bar", ".", overrides));
}

// A block that is pressed on a floor and then drawn along it, in steps that each go on from the last.
SceneDef drawn(const Overrides& overrides = {}) {
  return value(parse_scene(R"({
    "bodies": [{"name": "block", "element": "hex8",
                "mesh": {"box": {"upper": [0.1, 0.1, 0.05], "divisions": [3, 2, 2], "cell_type": "hex8"}},
                "materials": [{"young": 50000, "poisson": 0.4}]}],
    "analysis": {"steps": 6, "duration": 3},
    "dirichlet": [{"name": "press", "where": {"surfaces": "z1"}, "displacement": [0, 0, -0.003],
                   "amount": [[0, 0], [1, 1]]}],
    "tractions": [],
    "contacts": [{"name": "floor", "surfaces": ["z0"], "friction": 0.4, "compliance": 1e-7}],
    "forces": [{"name": "draw", "where": {"nearest": [[0, 0.05, 0.025]]}, "force": [-8, 1, 0],
                "amount": [[0, 0], [1, 0], [3, 1]]}],
    "probes": [{"name": "heel", "point": [0, 0.05, 0]}, {"name": "toe", "point": [0.1, 0.05, 0]}]
  })",
                           "drawn", ".", overrides));
}

SceneDef arm(const Overrides& overrides = {}) {
  Overrides all{"cavities.a.control=\"gas\"", "cavities.a.amount=[[0,1],[1,1.4]]",
                "cavities.a.polytropic=1.2"};
  all.insert(all.end(), overrides.begin(), overrides.end());
  return value(read_scene_file(ISOCHOR_SOURCE "/examples/drive/arm.json", all));
}

Experiment measured(const SceneDef& truth, const SceneDef& start, const std::string& columns,
                    const std::vector<double>& times) {
  std::string text = "time," + columns + "\n";
  const auto count = std::count(columns.begin(), columns.end(), ',') + 1;
  for (const double t : times) {
    text += inverse::full(t);
    for (std::ptrdiff_t k = 0; k < count; ++k) text += ",1";
    text += "\n";
  }
  inverse::Data data = value(inverse::parse_data(text, "made", truth));
  const inverse::Answer made = value(inverse::answer(truth, data, {}, 1));
  CAPTURE(made.reason);
  REQUIRE(made.found);
  for (std::size_t i = 0; i < data.values.size(); ++i)
    data.values[i].value = made.values[static_cast<Eigen::Index>(i)];
  return {"made", start, std::move(data), 1};
}

std::string set(const std::string& path, double v) {
  return path + "=" + inverse::full(v);
}

// Draws constants around where they begin, and asks for them back from what the scene then shows.
void comes_back(SceneDef (*scene)(const Overrides&),
                const std::vector<std::pair<std::string, double>>& constants, const std::string& columns,
                const std::vector<double>& times, unsigned seed, double within, double wide = 0.6) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> anywhere(-wide, wide);
  Overrides truth;
  std::vector<double> values;
  std::vector<Sought> sought;
  for (const auto& [path, start] : constants) {
    values.push_back(start * std::exp(anywhere(random)));
    truth.push_back(set(path, values.back()));
    sought.push_back({path, {}, {}});
  }
  SceneFitOptions options;
  options.threads = 1;
  const SceneFit fit =
      value(fit_scenes({measured(scene(truth), scene({}), columns, times)}, sought, options));
  CAPTURE(seed, fit.reason, fit.rms);
  for (std::size_t i = 0; i < values.size(); ++i) {
    CAPTURE(fit.constants[i].name, fit.start[i]);
    CHECK_THAT(fit.constants[i].value, WithinRel(values[i], within));
  }
}

}  // namespace

TEST_CASE("stiffnesses of springs, cables and fabric come back beside those of materials", "[fit]") {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    comes_back(bar,
               {{"springs[0].stiffness", 40},
                {"cables[0].stiffness", 900},
                {"layers[0].stiffness", 700},
                {"bodies[0].materials[0].young", 50000}},
               "tip.x,tip.y,tip.z,top.x,top.y,top.z,rope.tension,wall.force.x", {0.5, 1}, seed, 1e-6);
  }
}

TEST_CASE("what holds an effect and numbers of its loads are constants as well", "[fit]") {
  comes_back(bar, {{"springs[0].to[2]", 0.5}, {"tractions[0].traction[1]", 300}},
             "tip.x,tip.y,tip.z,wall.force.z", {0.5, 1}, 11, 1e-6, 0.2);
}

// What a point has slipped before has a say in what it pulls with: gradients at the equilibria alone would
// leave that out.
TEST_CASE("a coefficient of friction and the give of a floor come back from how a block is drawn", "[fit]") {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    comes_back(drawn, {{"contacts[0].friction", 0.4}, {"contacts[0].compliance", 1e-7}},
               "heel.x,heel.y,heel.z,toe.x,toe.z,floor.force.x,floor.force.z", {1, 1.5, 2, 2.5, 3}, seed,
               1e-5, 0.4);
  }
}

TEST_CASE("constants of a chamber with gas come back from pressures", "[fit]") {
  comes_back(arm, {{"cavities[0].polytropic", 1.2}}, "tip.x,a.pressure", {0.5, 1}, 3, 1e-5, 0.1);
}

TEST_CASE("constants of effects that are none are refused by name", "[fit]") {
  const Experiment good = measured(bar(), bar(), "tip.x,tip.y", {1});
  const auto refusal = [&](const std::string& path) {
    SceneFitOptions options;
    options.threads = 1;
    const auto made = fit_scenes({good}, {{path, {}, {}}}, options);
    REQUIRE_FALSE(made.ok());
    return made.error();
  };
  CHECK_THAT(refusal("springs[1].stiffness"), Contains("springs[1].stiffness"));
  CHECK_THAT(refusal("springs[0].name"), Contains("springs[0].name"));
  CHECK_THAT(refusal("springs[0].thickness"), Contains("springs[0].thickness"));
  CHECK_THAT(refusal("strings[0].stiffness"), Contains("springs[0].stiffness"));
  CHECK_THAT(refusal("springs[0]"), Contains("springs[0].stiffness"));
  // A spring that nothing is held by.
  CHECK_THAT(refusal("tractions[0].traction[3]"), Contains("traction[3]"));
}
