// Constants from curves: exact data give them back, measured ones are met, what data do not tell is said.
#include "studies/fit/fit.h"

#include <filesystem>
#include <fstream>
#include <random>

#include "catch.h"
#include "engine/elements/material_model.h"

using Catch::Matchers::WithinRel;
using namespace isochor;
using namespace isochor::fit;

namespace {

const Law& law(const std::string& name) {
  const auto found = find_law(name);
  REQUIRE(found);
  return *found.value();
}

// What the law answers, with errors of a share of the largest stress.
Curve curve_of(const Law& of, const std::vector<double>& constants, Mode mode, double to, double noise = 0,
               unsigned seed = 1, int points = 40) {
  Fit made;
  made.keys = of.keys(constants);
  const auto material = material_of(made);
  if (!material) FAIL(material.error());
  Curve curve{"made", mode, {}, {}, {}};
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (int i = 1; i <= points; ++i) {
    curve.stretch.push_back(1 + (to - 1) * i / points);
    curve.stress.push_back(stress(*material.value(), mode, curve.stretch.back()));
  }
  const double largest = curve.stress.back();
  for (double& s : curve.stress) s += noise * largest * normal(random);
  return curve;
}

std::filesystem::path file(const char* name, const std::string& text) {
  const auto path = std::filesystem::temp_directory_path() / name;
  std::ofstream(path) << text;
  return path;
}

std::string refusal(const std::string& name, const std::string& text, const CurveOptions& options = {}) {
  const auto path = file(name.c_str(), text);
  const auto read = read_curve(path.string(), options);
  std::filesystem::remove(path);
  REQUIRE(!read);
  return read.error();
}

struct Case {
  const char* law;
  std::vector<double> constants;
  double to;
};

}  // namespace

TEST_CASE("stresses of homogeneous states are those of the textbook") {
  Fit made;
  made.keys = law("mooney_rivlin_2").keys({3e3, 1e3});
  const MaterialPtr material = material_of(made).value();
  for (const double s : {0.6, 1.1, 2.0, 4.0}) {
    const double c1 = 3e3, c2 = 1e3;
    CHECK_THAT(stress(*material, Mode::uniaxial, s), WithinRel(2 * (c1 + c2 / s) * (s - 1 / (s * s)), 1e-12));
    CHECK_THAT(stress(*material, Mode::equibiaxial, s),
               WithinRel(2 * (c1 + c2 * s * s) * (s - std::pow(s, -5)), 1e-12));
    CHECK_THAT(stress(*material, Mode::pure_shear, s),
               WithinRel(2 * (c1 + c2) * (s - std::pow(s, -3)), 1e-12));
  }
}

TEST_CASE("data without noise give the constants back") {
  const Case cases[] = {{"neo_hookean", {21e3}, 3},
                        {"mooney_rivlin_2", {8e3, 2e3}, 2.5},
                        {"mooney_rivlin_3", {8e3, 2e3, 300}, 2.5},
                        {"yeoh_2", {9e3, 400}, 4},
                        {"yeoh_3", {9e3, -40, 3}, 5},
                        {"ogden_1", {14e3, 2.4}, 4},
                        {"ogden_2", {12e3, 1.8, 2e3, 5.5}, 4},
                        {"gent", {20e3, 60}, 5},
                        {"arruda_boyce", {20e3, 4.5}, 5}};
  for (const Case& c : cases) {
    INFO(c.law);
    // Two modes: one alone leaves some of them undetermined.
    const std::vector<Curve> curves{
        curve_of(law(c.law), c.constants, Mode::uniaxial, c.to),
        curve_of(law(c.law), c.constants, Mode::equibiaxial, 1 + 0.6 * (c.to - 1))};
    const Fit found = fit::fit(law(c.law), curves);
    INFO(found.reason);
    REQUIRE(found.converged);
    REQUIRE(found.constants.size() == c.constants.size());
    for (std::size_t i = 0; i < c.constants.size(); ++i)
      CHECK_THAT(found.constants[i].value, WithinRel(c.constants[i], 1e-6));
    CHECK(found.r2 > 1 - 1e-10);
  }
}

TEST_CASE("intervals hold the truth about as often as they say") {
  const std::vector<double> truth{20e3, 60};
  int held = 0, all = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const Fit found = fit::fit(law("gent"), {curve_of(law("gent"), truth, Mode::uniaxial, 5, 0.01, seed)});
    REQUIRE(found.converged);
    for (std::size_t i = 0; i < truth.size(); ++i, ++all)
      held += std::abs(found.constants[i].value - truth[i]) <= found.constants[i].half_width;
  }
  // 95 % of 120: outside 105 to 120 once in ten thousand times.
  CHECK(all == 120);
  CHECK(held >= 105);
  CHECK(held < 120);
}

TEST_CASE("constants that the data cannot tell apart are named") {
  // A narrow range of stretch is a straight line: one number for two constants.
  const Fit line = fit::fit(law("mooney_rivlin_2"),
                            {curve_of(law("mooney_rivlin_2"), {8e3, 2e3}, Mode::pure_shear, 1.5, 1e-3)});
  std::string said;
  for (const std::string& w : line.warnings) said += w + "\n";
  CHECK_THAT(said, ContainsSubstring("c1 and c2 cannot be told apart"));
}

TEST_CASE("pulled in one direction a law may be open in the others, and the fit says so") {
  const Curve pulled = curve_of(law("ogden_1"), {14e3, 2.4}, Mode::uniaxial, 2, 0.02, 3);
  const Fit found = fit::fit(law("mooney_rivlin_5"), {pulled});
  REQUIRE(found.uncertainty.contains("equibiaxial"));
  CHECK(found.uncertainty.at("equibiaxial") > 0.2);
  std::string said;
  for (const std::string& w : found.warnings) said += w + "\n";
  CHECK_THAT(said, ContainsSubstring("equibiaxial") && ContainsSubstring("measure that mode"));
  // The law that made the data is not.
  CHECK(fit::fit(law("ogden_1"), {pulled}).uncertainty.at("equibiaxial") < 0.2);
}

TEST_CASE("where a law turns over is told") {
  // Yeoh's with a negative second coefficient.
  const Fit found = fit::fit(law("yeoh_2"), {curve_of(law("yeoh_2"), {9e3, -150}, Mode::uniaxial, 3)});
  REQUIRE(found.converged);
  CHECK(found.stable_to < found.looked_to);
  CHECK(!found.stable_in_data);
  CHECK(found.stable_to > 1.5);
}

TEST_CASE("compression counts as tension does") {
  const std::vector<double> truth{8e3, 2e3};
  const Curve pressed = curve_of(law("mooney_rivlin_2"), truth, Mode::uniaxial, 0.5);
  const Curve pulled = curve_of(law("mooney_rivlin_2"), truth, Mode::uniaxial, 1.8);
  for (const std::vector<Curve>& curves :
       {std::vector<Curve>{pressed}, std::vector<Curve>{pressed, pulled}}) {
    const Fit found = fit::fit(law("mooney_rivlin_2"), curves);
    REQUIRE(found.converged);
    CHECK_THAT(found.constants[0].value, WithinRel(truth[0], 1e-6));
    CHECK_THAT(found.constants[1].value, WithinRel(truth[1], 1e-6));
    CHECK(found.stable_in_data);
    CHECK(found.uncertainty.at("equibiaxial") < 0.01);
  }
}

TEST_CASE("beyond its limit a law has no stress, and the range of stability ends there") {
  Fit gent;
  gent.keys = law("gent").keys({20e3, 10});
  const MaterialPtr material = material_of(gent).value();
  // I - 3 = 10 at equal stretches along x and y of 2.55.
  CHECK(std::isfinite(stress(*material, Mode::equibiaxial, 2.54)));
  CHECK(!std::isfinite(stress(*material, Mode::equibiaxial, 2.56)));
  const Fit found = fit::fit(law("gent"), {curve_of(law("gent"), {20e3, 10}, Mode::uniaxial, 3)});
  REQUIRE(found.converged);
  CHECK(found.stable_to > 2.5);
  CHECK(found.stable_to < 2.56);
}

TEST_CASE("more constants than points are refused") {
  const Fit found =
      fit::fit(law("ogden_3"), {curve_of(law("neo_hookean"), {1e4}, Mode::uniaxial, 2, 0, 1, 4)});
  CHECK(!found.converged);
  CHECK_THAT(found.reason, ContainsSubstring("4 points for 6 constants"));
}

TEST_CASE("a search that is stopped says that it found nothing") {
  FitOptions options;
  options.stop = [] { return true; };
  CHECK(!fit::fit(law("ogden_2"), {curve_of(law("ogden_1"), {14e3, 2.4}, Mode::uniaxial, 4)}, options)
             .converged);
}

TEST_CASE("curves are read as people write them") {
  const auto read = [](const char* name, const std::string& text, const CurveOptions& options = {}) {
    const auto path = file(name, text);
    const auto curve = read_curve(path.string(), options);
    std::filesystem::remove(path);
    if (!curve) FAIL(curve.error());
    return curve.value();
  };
  // The mark of UTF-8 that spreadsheets begin with is no part of a name.
  const Curve marked = read("isochor_m.csv", "\xEF\xBB\xBF\"x\",stress (kPa)\n0.1,1\n0.2,2\n0.3,3\n", [] {
    CurveOptions o;
    o.strain_column = "x";
    return o;
  }());
  CHECK(marked.stretch == std::vector<double>{1.1, 1.2, 1.3});
  // A preamble, semicolons, true numbers beside engineering ones.
  const Curve database = read(
      "isochor_a.csv",
      "PARAMETER;INFO\nStrain Measurement;Global\n;;\nTime (s);True Strain;True Stress (MPa);Engineering "
      "Strain;Engineering Stress "
      "(MPa)\n0.1;0.09;0.0011;0.1;0.001\n0.2;0.18;0.0024;0.2;0.002\n0.3;0.26;0.0039;0.3;0.003\n");
  CHECK(database.stretch == std::vector<double>{1.1, 1.2, 1.3});
  CHECK_THAT(database.stress[2], WithinRel(3000.0, 1e-12));
  const Curve true_alone = read("isochor_b.csv", "true strain,true stress (kPa)\n0.1,1\n0.2,2\n0.3,3\n");
  CHECK_THAT(true_alone.stretch[1], WithinRel(std::exp(0.2), 1e-12));
  CHECK_THAT(true_alone.stress[1], WithinRel(2000 / std::exp(0.2), 1e-12));
  CHECK(read("isochor_c.csv", "stretch\tstress [Pa]\n1.1\t100\n1.2\t200\n1.3\t300\n").stretch[0] == 1.1);
  CHECK_THAT(read("isochor_d.csv", "strain (%),stress (kPa)\n10,1\n20,2\n30,3\n").stretch[2],
             WithinRel(1.3, 1e-12));
  CHECK(read("isochor_e.csv", "strain;stress (kPa)\n0,1;1,5\n0,2;2,5\n0,3;3,5\n").stress[0] == 1500);
  // After the largest stress the specimen fails.
  const Curve failed = read("isochor_f.csv", "strain,stress (kPa)\n0.1,1\n0.2,2\n0.3,3\n0.4,1\n");
  CHECK(failed.stretch.size() == 3);
  CHECK_THAT(failed.note, ContainsSubstring("1 points beyond the largest stress"));
  const Curve both = read("isochor_q.csv", "strain,stress (kPa)\n-0.3,-9\n-0.2,-5\n0,0\n0.2,3\n0.4,5\n");
  CHECK(both.stretch.size() == 5);
  CHECK(read("isochor_r.csv", "strain,stress (kPa)\n-0.1,-2\n-0.2,-5\n-0.3,-9\n").stretch.size() == 3);
  CurveOptions range;
  range.lowest = 0.15;
  range.highest = 0.45;
  CHECK(read("isochor_g.csv", "strain,stress (kPa)\n0.1,1\n0.2,2\n0.3,3\n0.4,1\n0.5,1\n", range)
            .stretch.size() == 3);
}

TEST_CASE("what is no curve is refused with the line and the remedy") {
  CHECK_THAT(refusal("isochor_h.csv", "a,b\n1,2\n"), ContainsSubstring("no line names"));
  CHECK_THAT(refusal("isochor_i.csv", "strain,stress\n0.1,2\n"), ContainsSubstring("unit of the stress"));
  CHECK_THAT(refusal("isochor_j.csv", "strain,stress (kPa)\n0.1,1\n0.2,nan\n"),
             ContainsSubstring("line 3") && ContainsSubstring("nan"));
  CHECK_THAT(refusal("isochor_k.csv", "strain,stress (kPa)\n0.1,1\n0.2\n"),
             ContainsSubstring("fewer columns"));
  CHECK_THAT(refusal("isochor_l.csv", "strain,stress (kPa)\n-2,1\n"), ContainsSubstring("stretch of -1"));
  CHECK_THAT(refusal("isochor_m.csv", "strain,stress (kPa)\n"), ContainsSubstring("no points"));
  CHECK_THAT(refusal("isochor_n.csv", "strain,stress (kPa)\n0.1,1\n0.2,2\n"),
             ContainsSubstring("2 points that are stretched"));
  CHECK_THAT(refusal("isochor_o.csv", "strain,stress (Pa)\n0.1,.1\n0.2,.2\n.3,.3\n"),
             ContainsSubstring("check the unit"));
  CHECK_THAT(refusal("isochor_s.csv", "stretch,stress (kPa)\n1,1\n1,1\n1,1\n"),
             ContainsSubstring("0 points that are"));
  CHECK_THAT(refusal("isochor_t.csv", "strain,stress (kPa)\n0.1,3\n0.2,2\n0.3,1\n"),
             ContainsSubstring("largest stress"));
  CHECK_THAT(refusal("isochor_u.csv", "strain,stress (kPa)\n0.1,0\n0.2,0\n0.3,0\n"),
             ContainsSubstring("check the unit"));
  CurveOptions named;
  named.strain_column = "x";
  CHECK_THAT(refusal("isochor_p.csv", "strain,stress (kPa)\n0.1,1\n", named), ContainsSubstring("--strain"));
  CHECK_THAT(read_curve("nowhere.csv", {}).error(), ContainsSubstring("nowhere.csv"));
  CHECK_THAT(read_curve("nowhere.csv:sideways", {}).error(), ContainsSubstring("no mode"));
  CHECK_THAT(find_law("oggden").error(), ContainsSubstring("ogden_2"));
}
