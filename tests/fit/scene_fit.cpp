// Constants of scenes: data that a scene has made give its constants back, intervals hold what they say, and
// what data do not tell is named.
#include "studies/fit/scene_fit.h"

#include <cmath>
#include <random>

#include "catch.h"
#include "scenes/scene_file.h"
#include "studies/inverse/data_report.h"
#include "support/worlds.h"

using namespace isochor;
using namespace isochor::fit;
using Catch::Matchers::Contains;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
using test::value;

namespace {

SceneDef block(const Overrides& overrides = {}) {
  return value(parse_scene(R"({
    "bodies": [{"name": "block", "element": "hex8",
                "mesh": {"box": {"upper": [2, 1, 1], "divisions": [2, 1, 1], "cell_type": "hex8"}},
                "materials": [{"law": "mooney_rivlin", "c1": 300, "c2": 100, "poisson": 0.5}]}],
    "dirichlet": [{"name": "wall", "where": {"surfaces": "x0"}}],
    "tractions": [{"name": "pull", "surface": "x1", "traction": [500, 90, 0]}],
    "gravity": [0, 0, -0.01],
    "probes": [{"name": "tip", "point": [2, 0.5, 0.5]}]
  })",
                           "block", ".", overrides));
}

SceneDef arm(const Overrides& overrides = {}) {
  Overrides all{"cavities.a.amount=[[0,0],[1,9000]]"};
  all.insert(all.end(), overrides.begin(), overrides.end());
  return value(read_scene_file(ISOCHOR_SOURCE "/examples/drive/arm.json", all));
}

// What a scene answers at these times in these columns, with errors of a share of the largest change.
Experiment measured(const SceneDef& truth, const SceneDef& start, const std::string& columns,
                    const std::vector<double>& times, double noise = 0, unsigned seed = 1) {
  std::string text = "time," + columns + "\n";
  const auto count = std::count(columns.begin(), columns.end(), ',') + 1;
  for (const double t : times) {
    text += inverse::full(t);
    for (std::ptrdiff_t k = 0; k < count; ++k) text += ",1";
    text += "\n";
  }
  inverse::Data data = value(inverse::parse_data(text, "made", truth));
  const inverse::Answer made = value(inverse::answer(truth, data, {}, 1));
  REQUIRE(made.found);
  for (std::size_t i = 0; i < data.values.size(); ++i)
    data.values[i].value = made.values[static_cast<Eigen::Index>(i)];
  const Eigen::VectorXd scale = inverse::scales(data, made);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < data.values.size(); ++i)
    data.values[i].value += noise * scale[static_cast<Eigen::Index>(i)] * normal(random);
  return {"made", start, std::move(data), 1};
}

SceneFit fitted(const std::vector<Experiment>& experiments, const std::vector<Sought>& constants) {
  SceneFitOptions options;
  options.threads = 1;
  return value(fit_scenes(experiments, constants, options));
}

std::string refusal(const std::vector<Experiment>& experiments, const std::vector<Sought>& constants) {
  SceneFitOptions options;
  options.threads = 1;
  const auto made = fit_scenes(experiments, constants, options);
  REQUIRE_FALSE(made.ok());
  return made.error();
}

std::string override_of(const std::string& path, double v) {
  return path + "=" + inverse::full(v);
}

const std::string c1 = "bodies[0].materials[0].c1", c2 = "bodies[0].materials[0].c2",
                  young = "bodies[0].materials[0].young", density = "bodies[0].materials[0].density";

}  // namespace

TEST_CASE("gradients of what a scene answers are those of differences", "[fit]") {
  const auto at = [](double c, bool gradients) {
    const SceneDef scene = block({override_of(c1, c)});
    inverse::Data data = value(inverse::parse_data(
        "time,tip.x,tip.y,tip.z,wall.force.x,wall.force.y,wall.moment.z\n0.5,1,1,1,1,1,1\n1,1,1,1,1,1,1\n",
        "d", scene));
    inverse::ParametersOf parameters;
    if (gradients) {
      parameters = [&](const BuiltScene& built) -> Result<std::vector<Parameter>> {
        return std::vector{Parameter::material(built.bodies[0], "", c, [](double v) -> Result<MaterialPtr> {
          return mooney_rivlin({.c1 = v, .c2 = 100, .poisson = 0.5});
        })};
      };
    }
    return value(inverse::answer(scene, data, parameters, 1));
  };
  const inverse::Answer here = at(320, true), above = at(320.5, false), below = at(319.5, false);
  REQUIRE(here.jacobian.rows() == 12);
  for (Eigen::Index i = 0; i < 12; ++i) {
    const double difference = above.values[i] - below.values[i];
    CAPTURE(i, here.values[i]);
    CHECK_THAT(here.jacobian(i, 0), WithinAbs(difference, 1e-5 * std::abs(difference) + 1e-10));
  }
}

TEST_CASE("data without errors give the constants of a scene back", "[fit]") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> anywhere(-1, 1);
  SECTION("two constants of a block from two experiments: a probe, and forces of its wall") {
    for (int k = 0; k < 4; ++k) {
      const double a = 300 * std::exp(0.8 * anywhere(random)), b = 100 * std::exp(0.8 * anywhere(random));
      CAPTURE(k, a, b);
      const Overrides truth{override_of(c1, a), override_of(c2, b)};
      const std::string pressed = "tractions.pull.traction=[-150,0,40]";
      const SceneFit fit = fitted({measured(block(truth), block(), "tip.x,tip.y", {0.5, 1}),
                                   measured(block({truth[0], truth[1], pressed}), block({pressed}),
                                            "tip.x,wall.force.y,tip.z", {0.3, 1})},
                                  {{c1, {}, {}}, {c2, {}, {}}});
      CHECK(fit.converged);
      CHECK_THAT(fit.constants[0].value, WithinRel(a, 1e-6));
      CHECK_THAT(fit.constants[1].value, WithinRel(b, 1e-6));
      CHECK(fit.rms < 1e-6);
    }
  }
  SECTION("modulus and density of an arm from the bend and the volume at pressures") {
    const double a = 40e3 * std::exp(0.5 * anywhere(random)), b = 1070 * std::exp(0.3 * anywhere(random));
    CAPTURE(a, b);
    const SceneFit fit = fitted({measured(arm({override_of(young, a), override_of(density, b)}), arm(),
                                          "tip.x,tip.z,a.volume", {0.25, 0.5, 1})},
                                {{young, {}, {}}, {density, {}, {}}});
    CHECK(fit.converged);
    CHECK_THAT(fit.constants[0].value, WithinRel(a, 1e-6));
    CHECK_THAT(fit.constants[1].value, WithinRel(b, 1e-6));
  }
}

TEST_CASE("intervals of constants of scenes hold the truth as often as they say", "[fit]") {
  int inside = 0;
  constexpr int sets = 60;
  for (unsigned seed = 1; seed <= sets; ++seed) {
    const SceneFit fit =
        fitted({measured(block(), block({override_of(c1, 400)}), "tip.x,tip.y,tip.z", {0.5, 1}, 0.01, seed)},
               {{c1, {}, {}}});
    REQUIRE(fit.converged);
    inside += std::abs(fit.constants[0].value - 300) <= fit.constants[0].half_width ? 1 : 0;
  }
  // 57 are expected; fewer than 51, or all, of a binomial of 0.95: both below 5 %.
  CHECK(inside >= 51);
}

TEST_CASE("a scene fit names what the data do not tell", "[fit]") {
  SECTION("the sag under gravity tells density over modulus alone") {
    const Overrides sag{"tractions.pull.traction=[0,0,0]", "gravity=[0,0,-0.02]"};
    const SceneFit fit = fitted({measured(block(sag), block(sag), "tip.z,tip.x", {0.5, 0.7, 1})},
                                {{c1, {}, {}}, {c2, {}, {}}, {density, {}, {}}});
    REQUIRE_FALSE(fit.warnings.empty());
    CHECK_THAT(fit.warnings.back(), Contains("cannot be told apart") && Contains("density"));
    const SceneFit alone =
        fitted({measured(block(sag), block(sag), "tip.z,tip.x", {0.5, 0.7, 1})}, {{density, {}, {}}});
    CHECK(alone.warnings.empty());
  }
  SECTION("a bound that holds") {
    const SceneFit fit =
        fitted({measured(block({override_of(c1, 500)}), block(), "tip.x,tip.y", {0.5, 1})}, {{c1, 200, 400}});
    CHECK(fit.constants[0].at_bound);
    CHECK_THAT(fit.constants[0].value, WithinRel(400, 1e-6));
    CHECK_THAT(fit.warnings.front(), Contains("end of its range"));
  }
}

TEST_CASE("scene fits refuse what means nothing", "[fit]") {
  const Experiment good = measured(block(), block(), "tip.x,tip.y", {0.5, 1});
  CHECK_THAT(refusal({good}, {}), Contains("--constant"));
  CHECK_THAT(refusal({good}, {{"bodies[0].materials[0].c3", {}, {}}}), Contains("c3"));
  CHECK_THAT(refusal({good}, {{"gravity_amount", {}, {}}}), Contains("bodies[0].materials[0].young"));
  CHECK_THAT(refusal({good}, {{c1, {}, {}}, {c1, {}, {}}}), Contains("twice"));
  CHECK_THAT(refusal({good}, {{c1, 1000, 2000}}), Contains("outside of its bounds"));
  const Experiment one = measured(block(), block(), "tip.x", {1});
  CHECK_THAT(refusal({one}, {{c1, {}, {}}, {c2, {}, {}}}), Contains("1 numbers for 2 constants"));
  const Overrides floating{"gravity=[0,0,0]"};
  CHECK_THAT(
      refusal({measured(block(floating), block(floating), "tip.x,tip.y", {0.5, 1})}, {{density, {}, {}}}),
      Contains("nothing that was measured depends on " + density));
  Experiment millimeters = good;
  for (inverse::Datum& d : millimeters.data.values) d.value *= 1000;
  CHECK_THAT(refusal({millimeters}, {{c1, {}, {}}}), Contains("meters"));
  Experiment kilonewtons = measured(block(), block(), "wall.force.x,tip.x", {0.5, 1});
  for (inverse::Datum& d : kilonewtons.data.values) {
    if (d.quantity == 0) d.value *= 1e-3;
  }
  CHECK_THAT(refusal({kilonewtons}, {{c1, {}, {}}}), Contains("SI units"));
}

TEST_CASE("data files of scenes are read, and what is wrong in them is named", "[fit]") {
  const SceneDef scene = block();
  const auto told = [&](const std::string& text) {
    const auto read = inverse::parse_data(text, "data.csv", scene);
    REQUIRE_FALSE(read.ok());
    return read.error();
  };
  CHECK_THAT(told("time,tip.x\n1,nan\n"), Contains("data.csv:2") && Contains("finite"));
  CHECK_THAT(told("time,tip.x\n1,2\n1,3\n"), Contains("not after"));
  CHECK_THAT(told("time,tip.w\n1,2\n"), Contains("tip.x"));
  CHECK_THAT(told("time,tip.x,tip.x\n1,2,2\n"), Contains("twice"));
  CHECK_THAT(told("time,air.volume\n1,2\n"), Contains("air.volume"));
  CHECK_THAT(told("time,tip.x\n1,2,3\n"), Contains("3 columns"));
  CHECK_THAT(told("tip.x\n1\n"), Contains("\"time\""));
  CHECK_THAT(told("time,X,Y,Z,x,y\n1,0,0,0,0,0\n"), Contains("'z'"));
  CHECK_THAT(told("time,tip.x\n"), Contains("no number"));
  const inverse::Data gaps = value(inverse::parse_data("time,tip.x,tip.y\n1,,0.5\n2,2.1,\n", "d", scene));
  REQUIRE(gaps.values.size() == 2);
  CHECK(gaps.values[0].quantity == 1);
  CHECK(gaps.values[1].step == 1);
  const inverse::Data markers =
      value(inverse::parse_data("time,X,Y,Z,x,y,z\n1,2,0,0,2.1,0,0\n1,2,1,0,2.2,1,0\n", "d", scene));
  CHECK(markers.values.size() == 6);
  CHECK(markers.time.size() == 1);
}
