// The runner: statuses, outputs, probes and metrics.
#include <cmath>
#include <nlohmann/json.hpp>

#include "catch.h"
#include "isochor/generate.h"
#include "scenes/probes.h"
#include "small_scene.h"

using namespace isochor;
using Json = nlohmann::json;
namespace fs = std::filesystem;

TEST_CASE("a run leaves frames, table, page and summary") {
  test::Scratch scratch("outputs");
  RunOptions options;
  options.folder = (scratch / "out").string();
  int calls = 0;
  options.on_step = [&](const StepRecord&, int steps) { calls += steps == 3; };
  const RunResult r = run_scene(test::small_scene(), options);
  REQUIRE(r.status == RunStatus::converged);
  CHECK(calls == 3);
  CHECK(r.records.size() == 4);
  REQUIRE(r.metrics.size() == 1);
  CHECK(r.metrics[0].value > 0.1);
  for (const char* file : {"frames/small_00000.vtu", "frames/small_00003.vtu", "small.pvd", "steps.csv"}) {
    INFO(file);
    CHECK(fs::exists(scratch / "out" / file));
  }
  const Json j = Json::parse(test::slurp(scratch / "out" / "summary.json"));
  for (const char* key : {"status",
                          "reason",
                          "scene",
                          "steps",
                          "newton_iterations",
                          "factorizations",
                          "wall_s",
                          "stage_s",
                          "unknowns",
                          "elements",
                          "volume_row_residual",
                          "constitutive_residual",
                          "volume_change",
                          "volumes",
                          "gravity_potential_J",
                          "load_potential_J",
                          "potential_energy_J",
                          "total_energy_J",
                          "linear_momentum_kg_m_s",
                          "angular_momentum_kg_m2_s",
                          "min_J",
                          "max_J",
                          "probes",
                          "cavities",
                          "reactions",
                          "metrics",
                          "state_hash",
                          "version",
                          "machine",
                          "threads",
                          "warnings"}) {
    INFO(key);
    CHECK(j.contains(key));
  }
  CHECK(j["status"] == "converged");
  CHECK(j["probes"]["tip"][0] == Approx(r.metrics[0].value));
  CHECK(j["reactions"]["wall"]["force_N"][0] == Approx(-100));
  CHECK(j["state_hash"].get<std::string>().size() == 16);
  const std::string table = test::slurp(scratch / "out" / "steps.csv");
  CHECK(std::count(table.begin(), table.end(), '\n') == 5);
}

TEST_CASE("a shorter run leaves no frames of the longer one before it") {
  test::Scratch scratch("stale");
  RunOptions options;
  options.folder = scratch.string();
  REQUIRE(run_scene(test::small_scene(), options).status == RunStatus::converged);
  REQUIRE(run_scene(test::small_scene({"analysis.steps=1"}), options).status == RunStatus::converged);
  CHECK_FALSE(fs::exists(scratch / "frames/small_00003.vtu"));
  CHECK(fs::exists(scratch / "frames/small_00001.vtu"));
}

TEST_CASE("outputs that cannot be written are refused before the solve") {
  RunOptions options;
  options.folder = "/proc/isochor";
  const RunResult r = run_scene(test::small_scene(), options);
  CHECK(r.status == RunStatus::bad_input);
  CHECK_THAT(r.reason, Catch::Matchers::Contains("/proc/isochor"));
  CHECK(r.records.empty());
}

TEST_CASE("budget, interruption and failure keep what was reached") {
  test::Scratch scratch("stops");
  RunOptions options;
  options.folder = scratch.string();
  SECTION("interrupted after a step") {
    int steps = 0;
    options.on_step = [&](const StepRecord&, int) { ++steps; };
    options.stop = [&] { return steps >= 1; };
    const RunResult r = run_scene(test::small_scene(), options);
    CHECK(r.status == RunStatus::interrupted);
    CHECK(r.records.size() == 2);
    CHECK(Json::parse(test::slurp(scratch / "summary.json"))["status"] == "interrupted");
    CHECK(fs::exists(scratch / "frames/small_00001.vtu"));
    CHECK_FALSE(r.metrics[0].reached);
  }
  SECTION("out of budget") {
    options.budget = 1e-9;
    const RunResult r = run_scene(test::small_scene(), options);
    CHECK(r.status == RunStatus::budget);
    CHECK(r.records.size() == 1);
  }
  SECTION("no equilibrium") {
    // A point load that no soft block carries in two iterations.
    const RunResult r =
        run_scene(test::small_scene({"analysis.max_iterations=1", "tractions.pull.amount=1000"}), options);
    CHECK(r.status == RunStatus::not_converged);
    CHECK(r.wall_s >= r.stages.total);  // of steps that were not taken as well
    CHECK_FALSE(r.reason.empty());
    CHECK(Json::parse(test::slurp(scratch / "summary.json"))["status"] == "not_converged");
  }
}

TEST_CASE("dynamics falls freely") {
  const RunResult r =
      run_scene(test::small_scene({"analysis={\"type\":\"dynamic\",\"duration\":0.1,\"step\":0.001}",
                                   "dirichlet=[]", "tractions=[]", "gravity=[0,0,-10]"}));
  INFO(r.reason);
  REQUIRE(r.status == RunStatus::converged);
  // Implicit Euler: half g t (t + h).
  CHECK(r.records.back().probes[0].z == Approx(-0.5 * 10 * 0.1 * 0.101).epsilon(1e-6));
}

TEST_CASE("the same bits at every thread count") {
  RunOptions one, two;
  one.threads = 1;
  two.threads = 2;
  CHECK(run_scene(test::small_scene(), one).state_hash == run_scene(test::small_scene(), two).state_hash);
}

TEST_CASE("two bodies have a series of frames each") {
  test::Scratch scratch("two");
  RunOptions options;
  options.folder = scratch.string();
  const RunResult r =
      run_scene(test::small_scene(
                    {"bodies[1]={\"name\":\"other\",\"mesh\":{\"box\":{\"lower\":[5,0,0],\"upper\":[6,1,1]}},"
                     "\"element\":\"tet10\",\"materials\":[{\"young\":1e4,\"poisson\":0.3}]}",
                     "dirichlet[1]={\"name\":\"floor\",\"where\":{\"body\":\"other\",\"surfaces\":\"y0\"}}"}),
                options);
  INFO(r.reason);
  CHECK(r.status == RunStatus::converged);
  CHECK(fs::exists(scratch / "small_block.pvd"));
  CHECK(fs::exists(scratch / "small_other.pvd"));
}

TEST_CASE("probes are interpolated where no node is") {
  for (const CellType type : {CellType::tet4, CellType::tet10}) {
    auto mesh = box_mesh({{}, {1, 1, 1}, {2, 2, 2}, type});
    REQUIRE(mesh.ok());
    const Vec3 point{0.3, 0.21, 0.77};
    const MaterialPoint p = locate(mesh.value(), point);
    CHECK(p.distance == 0);
    const Vec3 x = p.at(mesh.value().nodes);
    CHECK(x.x == Approx(point.x));
    CHECK(x.y == Approx(point.y));
    CHECK(x.z == Approx(point.z));
    CHECK(locate(mesh.value(), {3, 0, 0}).distance == Approx(2));
  }
}

TEST_CASE("metrics know reference, tolerance and time") {
  const RunResult r = run_scene(test::small_scene(
      {"metrics[0].reference=0.1", "metrics[0].tolerance=0.001",
       "metrics[1]={\"name\":\"wall\",\"quantity\":\"reaction_force\",\"of\":\"wall\",\"component\":\"x\","
       "\"scale\":-1,"
       "\"reference\":100,\"tolerance\":1e-6}",
       "metrics[2]={\"name\":\"early\",\"of\":\"tip\",\"component\":\"x\",\"time\":0.3333333333333333}"}));
  REQUIRE(r.metrics.size() == 3);
  CHECK(r.metrics[0].within == false);
  CHECK(r.metrics[1].within == true);
  CHECK(r.metrics[2].value < r.metrics[0].value);
}
