// Volumes, energies, momentum and orientations as metrics, columns and entries of the summary; where cuts
// open.
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "catch.h"
#include "scenes/run/section_plane.h"
#include "small_scene.h"

using namespace isochor;
using Json = nlohmann::json;

namespace {

double value_of(const RunResult& r, const std::string& metric) {
  for (const MetricValue& m : r.metrics) {
    if (m.def.name == metric) return m.value;
  }
  FAIL("no metric " << metric);
  return 0;
}

// The last line of a table, by the names of its columns.
std::map<std::string, double> last_row(const std::string& text) {
  std::stringstream lines(text);
  std::string head, line, last;
  std::getline(lines, head);
  while (std::getline(lines, line)) last = line;
  std::stringstream names(head), numbers(last);
  std::map<std::string, double> row;
  std::string name, number;
  while (std::getline(names, name, ',')) {
    REQUIRE(std::getline(numbers, number, ','));
    INFO(name);
    CHECK(row.emplace(name, std::stod(number)).second);  // no column twice
  }
  CHECK_FALSE(std::getline(numbers, number, ','));
  return row;
}

std::string error_with(const std::string& change) {
  auto scene = parse_scene(test::small_text(), "small.json", ".", {change});
  if (!scene) return scene.error();
  const auto built = build(scene.value());
  return built ? "" : built.error();
}

// A box as triangles seen from outside.
void add_box(const Vec3& low, const Vec3& high, std::vector<Vec3>& points, std::vector<Index>& triangles) {
  const auto first = static_cast<Index>(points.size());
  for (int k = 0; k < 8; ++k)
    points.push_back({k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z});
  for (const Index c : {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                        2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5})
    triangles.push_back(first + c);
}

}  // namespace

TEST_CASE("a block that is turned and squeezed says by how much, in every output") {
  test::Scratch scratch("measures");
  RunOptions options;
  options.folder = scratch.string();
  const RunResult r = run_scene(
      test::small_scene(
          {"tractions=[]", "bodies[0].materials[0].poisson=0.3", "bodies[0].element=\"tet4\"",
           // Every node turned by 40 degrees about z: a rigid motion.
           R"(dirichlet=[{"name": "wall", "where": {"everything": true}, "rotation": {"point": [0, 0, 0], "axis": [0, 0, 1], "angle_deg": 40}}])",
           R"(orientations=[{"name": "end", "where": {"surfaces": "x1"}}])",
           R"(metrics=[{"name": "angle", "quantity": "orientation_angle", "of": "end"},
                {"name": "axis", "quantity": "orientation_axis", "of": "end", "component": "z"},
                {"name": "normal", "quantity": "orientation_normal", "of": "end", "component": "y"},
                {"name": "moved", "of": "end", "component": "x"},
                {"name": "change", "quantity": "volume_change", "of": "block"},
                {"name": "volume", "quantity": "volume"},
                {"name": "least", "quantity": "min_J", "of": "block"},
                {"name": "old name", "quantity": "volume_error"}, {"name": "new name", "quantity": "volume_row_residual"}])"}),
      options);
  INFO(r.reason);
  REQUIRE(r.status == RunStatus::converged);
  const double c = std::cos(std::acos(-1.0) * 40 / 180), s = std::sqrt(1 - c * c);
  CHECK(value_of(r, "angle") == Approx(40));
  CHECK(value_of(r, "axis") == Approx(1));
  CHECK(value_of(r, "normal") == Approx(s));
  CHECK(value_of(r, "moved") == Approx(2 * c - 0.5 * s - 2));
  CHECK(std::abs(value_of(r, "change")) < 1e-12);
  CHECK(value_of(r, "volume") == Approx(2));
  CHECK(value_of(r, "least") == Approx(1));
  CHECK(value_of(r, "old name") == value_of(r, "new name"));
  const auto row = last_row(test::slurp(scratch / "steps.csv"));
  CHECK(row.at("end.angle_deg") == Approx(40));
  CHECK(row.at("end.normal_y") == Approx(s));
  CHECK(row.at("block.body_volume_m3") == Approx(2));
  CHECK(row.contains("volume_row_residual"));
  CHECK_FALSE(row.contains("volume_error"));
  const Json j = Json::parse(test::slurp(scratch / "summary.json"));
  CHECK(j["gauges"]["end"]["angle_deg"].get<double>() == Approx(40));
  CHECK(j["volumes"]["block"]["rest_volume_m3"].get<double>() == Approx(2));
  CHECK_FALSE(j.contains("volume_error"));
}

TEST_CASE("energies of a run add up, and a fall keeps their sum") {
  test::Scratch scratch("energies");
  RunOptions options;
  options.folder = scratch.string();
  const RunResult r = run_scene(
      test::small_scene(
          {R"(analysis={"type": "dynamic", "scheme": "implicit_midpoint", "duration": 0.1, "step": 0.01})",
           "dirichlet=[]", "gravity=[0,0,-10]", "bodies[0].velocity=[1,0,0]", "tractions=[]",
           R"(metrics=[{"name": "total", "quantity": "total_energy"}, {"name": "weight", "quantity": "gravity_potential"},
                {"name": "kinetic", "quantity": "kinetic_energy"}, {"name": "potential", "quantity": "potential_energy"},
                {"name": "loads", "quantity": "load_potential"},
                {"name": "momentum", "quantity": "linear_momentum", "component": "x"},
                {"name": "of body", "quantity": "linear_momentum", "of": "block", "component": "z"},
                {"name": "spin", "quantity": "angular_momentum", "component": "x"}])"}),
      options);
  INFO(r.reason);
  REQUIRE(r.status == RunStatus::converged);
  const double mass = 2000, fallen = 0.5 * 10 * 0.1 * 0.1;
  CHECK(value_of(r, "total") == Approx(0.5 * mass).epsilon(1e-8));
  CHECK(value_of(r, "weight") == Approx(-mass * 10 * fallen).epsilon(1e-6));
  CHECK(value_of(r, "kinetic") == Approx(0.5 * mass * (1 + 1)).epsilon(1e-6));
  CHECK(value_of(r, "potential") == Approx(value_of(r, "weight")).epsilon(1e-6));
  CHECK(value_of(r, "loads") == 0);
  CHECK(value_of(r, "momentum") == Approx(mass).epsilon(1e-8));
  CHECK(value_of(r, "of body") == Approx(-mass).epsilon(1e-8));
  CHECK(value_of(r, "spin") == Approx(-0.5 * mass).epsilon(1e-6));
  const auto row = last_row(test::slurp(scratch / "steps.csv"));
  CHECK(row.at("total_energy_J") == Approx(0.5 * mass).epsilon(1e-8));
  CHECK(row.at("linear_momentum_z_kg_m_s") == Approx(-mass).epsilon(1e-8));
}

TEST_CASE("what is watched and is not there is refused with what there is") {
  CHECK_THAT(error_with(R"(orientations=[{"name": "a", "where": {"nearest": [[0, 0, 0]]}}])"),
             ContainsSubstring("orientations[0].where") && ContainsSubstring("one line or in one point"));
  CHECK_THAT(error_with(R"(orientations=[{"name": "a", "where": {"surfaces": "lid"}}])"),
             ContainsSubstring("orientations[0].where") && ContainsSubstring("\"lid\""));
  CHECK_THAT(error_with(R"(orientations=[{"name": "wall", "where": {"surfaces": "x1"}}])"),
             ContainsSubstring("used already"));
  CHECK_THAT(error_with(R"(metrics=[{"name": "m", "quantity": "volume_change", "of": "block.lid"}])"),
             ContainsSubstring("metrics[0].of") && ContainsSubstring("\"block\""));
  CHECK_THAT(error_with(R"(metrics=[{"name": "m", "quantity": "min_J", "of": "lid"}])"),
             ContainsSubstring("names no body"));
  CHECK_THAT(error_with(R"(metrics=[{"name": "m", "quantity": "orientation_angle", "of": "tip"}])"),
             ContainsSubstring("names no orientation"));
  CHECK_THAT(error_with(R"(metrics=[{"name": "m", "quantity": "total_energy", "of": "block"}])"),
             ContainsSubstring("whole scene"));
}

TEST_CASE("cuts go where most is seen, whatever the axes") {
  // A long, wide and flat room beside a small one: the plane across its shortest side shows the most of it.
  for (int turn = 0; turn < 3; ++turn) {
    INFO(turn);
    const auto turned = [&](const Vec3& v) {
      Vec3 out;
      for (int k = 0; k < 3; ++k) out[(k + turn) % 3] = v[k];
      return out;
    };
    std::vector<Vec3> points;
    std::vector<Index> triangles;
    add_box({0, 0, 0}, {10, 4, 1}, points, triangles);
    add_box({3, 1, 7}, {4, 2, 8}, points, triangles);
    for (Vec3& p : points) p = turned(p);
    const PageSection s = section_through(points, triangles, 'z');
    CHECK(s.axis == (2 + turn) % 3);
    CHECK(s.at[s.axis] == Approx(0.5).epsilon(1e-3));
  }
  // Of two halves of a scene that are far apart the plane meets one, and not the gap between them.
  std::vector<Vec3> points;
  std::vector<Index> triangles;
  add_box({0, 0, 0}, {1, 1, 1}, points, triangles);
  add_box({5, 0, 0}, {6, 1, 1}, points, triangles);
  const PageSection s = section_through(points, triangles, 'z');
  CHECK(s.axis == 1);
  CHECK((s.at.x < 1 || s.at.x > 5));
  // Seen from above it would show more; upright planes show how a body stands.
  points.clear();
  triangles.clear();
  add_box({0, 0, 0}, {2, 2, 1.5}, points, triangles);
  CHECK(section_through(points, triangles, 'z').axis == 1);
  CHECK(section_through(points, triangles, 'y').axis == 2);
}
