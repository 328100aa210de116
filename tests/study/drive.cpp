// `isochor drive`: a three-chamber arm whose tip is told where to be.
#include "studies/drive/drive.h"

#include <algorithm>
#include <cmath>

#include "catch.h"
#include "isochor/gradients.h"
#include "scenes/effects/kind.h"
#include "scenes/run/run.h"
#include "scenes/scene_file.h"
#include "studies/drive/bounded.h"
#include "studies/drive/report.h"
#include "support/worlds.h"

using namespace isochor;
using namespace isochor::drive;
using Catch::Matchers::WithinAbs;
using test::value;

namespace {

SceneDef arm(const Overrides& overrides = {}) {
  return value(read_scene_file(ISOCHOR_SOURCE "/examples/drive/arm.json", overrides));
}

std::vector<Actuator> chambers(double most = 40e3, double rate = std::numeric_limits<double>::infinity()) {
  return {{"a", 0, most, rate}, {"b", 0, most, rate}, {"c", 0, most, rate}};
}

Drive driven(const SceneDef& scene, std::vector<Actuator> actuators, const std::string& targets) {
  DriveOptions options;
  options.threads = 1;
  return value(
      drive::drive(scene, std::move(actuators), value(parse_targets(targets, "targets", scene)), options));
}

template <class T>
std::string refusal(const Result<T>& result) {
  REQUIRE_FALSE(result.ok());
  return result.error();
}

double squared_error(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, const Eigen::VectorXd& u) {
  return (A * u - b).squaredNorm();
}

}  // namespace

TEST_CASE("the tip of a three-chamber arm goes around a circle", "[drive]") {
  const SceneDef scene = arm();
  DriveOptions options;
  options.threads = 1;
  const Drive d = value(drive::drive(
      scene, chambers(), value(read_targets(ISOCHOR_SOURCE "/examples/drive/circle.csv", scene)), options));
  CHECK(d.reason.empty());
  CHECK(d.all_reached());
  REQUIRE(d.steps.size() == 26);
  for (const Reached& r : d.steps) {
    CAPTURE(r.time, r.distance);
    CHECK(r.distance < 1e-6);
    for (const double amount : r.amount) {
      CHECK(amount >= 0);
      CHECK(amount <= 40e3);
    }
  }
  // A run with the amounts found goes the same way.
  const SceneDef again = value(driven_scene(scene, d));
  RunOptions run;
  run.threads = 1;
  const RunResult result = run_scene(again, run);
  REQUIRE(result.status == RunStatus::converged);
  REQUIRE(result.records.size() == d.steps.size() + 1);
  for (std::size_t k = 0; k < d.steps.size(); ++k) {
    CHECK_THAT(result.records[k + 1].probes[0].x, WithinAbs(d.targets.value[k][0], 2e-6));
    CHECK_THAT(result.records[k + 1].probes[0].y, WithinAbs(d.targets.value[k][1], 2e-6));
  }
  // Two components and three chambers: what is not needed changes little.
  const auto lines = drive_csv(d);
  CHECK(std::count(lines.begin(), lines.end(), '\n') == 27);
  CHECK_THAT(drive_json(d), Catch::Matchers::Contains("\"all_reached\": true"));
}

TEST_CASE("bounds and rates are kept, and a target out of reach is come to as near as they allow",
          "[drive]") {
  const SceneDef scene = arm();
  // Far beyond what 8 kPa do.
  const Drive d = driven(scene, chambers(8e3), "time,tip.x,tip.y\n1,0.05,0.01\n");
  REQUIRE(d.steps.size() == 1);
  const Reached& r = d.steps[0];
  CHECK_FALSE(r.reached);
  CHECK(r.nearest);
  CHECK_FALSE(d.all_reached());
  CHECK_FALSE(r.at_bound.empty());
  for (const double amount : r.amount) {
    CHECK(amount >= 0);
    CHECK(amount <= 8e3);
  }
  // No amounts nearby, within the bounds, come closer.
  for (std::size_t i = 0; i < 3; ++i) {
    for (const double by : {-200.0, 200.0}) {
      const double moved = r.amount[i] + by;
      if (moved < 0 || moved > 8e3) continue;
      SceneDef other = value(driven_scene(scene, d));
      other.cavities[i].amount.points.back()[1] = moved;
      RunOptions run;
      run.threads = 1;
      const RunResult there = run_scene(other, run);
      REQUIRE(there.status == RunStatus::converged);
      const Vec3 x = there.records.back().probes[0];
      CAPTURE(i, by);
      CHECK(std::hypot(x.x - 0.05, x.y - 0.01) > r.distance);
    }
  }
  const Drive slow = driven(scene, chambers(40e3, 3e3),
                            "time,tip.x,tip.y\n1,0.004,0\n2,0.004,0\n3,0.004,0\n4,0.004,0\n5,0.004,0\n");
  CHECK_FALSE(slow.steps[0].reached);
  CHECK(slow.steps.back().reached);
  std::vector<double> before{2000, 2000, 2000};
  for (const Reached& step : slow.steps) {
    for (std::size_t i = 0; i < 3; ++i) CHECK(std::abs(step.amount[i] - before[i]) <= 3e3 * (1 + 1e-12));
    before = step.amount;
  }
}

TEST_CASE("of all amounts that reach a target those are taken that change least", "[drive]") {
  const SceneDef scene = arm();
  const Drive d = driven(scene, chambers(), "time,tip.x\n1,0.001\n");
  REQUIRE(d.all_reached());
  // One component, three chambers: the least change is along the gradient of the component.
  const SceneDef there = value(driven_scene(scene, d));
  BuiltScene built = value(build(there, {.threads = 1}));
  test::must_advance(built.world);
  GradientQuery query;
  query.outputs = {Output::material_point(built.bodies[0], {0, 0, 0.2}, {1, 0, 0})};
  for (const EffectId chamber : built.ids(cavities_kind))
    query.parameters.push_back(Parameter::amount_of(chamber));
  const Gradients g = value(built.world.gradients(query));
  double along = 0, change = 0, gradient = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double moved = d.steps[0].amount[i] - 2000;
    along += moved * g.of(0, i);
    change += moved * moved;
    gradient += g.of(0, i) * g.of(0, i);
  }
  CHECK(along > 0.99999 * std::sqrt(change * gradient));
}

TEST_CASE("bounded least squares end at the corner or edge where the gradient says so", "[drive]") {
  Eigen::MatrixXd A(4, 3);
  A << 3, 1, -1, 0, 2, 1, 1, -1, 2, 0.5, 0, 1;
  Eigen::VectorXd b(4);
  b << 5, -4, 3, 2;
  const Eigen::VectorXd least = Eigen::VectorXd::Constant(3, -0.7), most = Eigen::VectorXd::Constant(3, 1.1);
  const Bounded found = least_squares(A, b, least, most);
  REQUIRE(found.converged);
  const Eigen::VectorXd gradient = A.transpose() * (A * found.u - b);
  for (Eigen::Index i = 0; i < 3; ++i) {
    CAPTURE(i, found.u[i], gradient[i]);
    CHECK(found.u[i] >= least[i]);
    CHECK(found.u[i] <= most[i]);
    if (found.u[i] > least[i] && found.u[i] < most[i])
      CHECK_THAT(gradient[i], WithinAbs(0, 1e-9));
    else
      CHECK((found.u[i] == least[i] ? gradient[i] > 0 : gradient[i] < 0));
  }
  for (const double u : {-0.7, 0.0, 0.5, 1.1}) {
    const Eigen::VectorXd other = Eigen::VectorXd::Constant(3, u);
    CHECK(squared_error(A, b, found.u) <= squared_error(A, b, other));
  }
}

TEST_CASE("forces of supports, volumes and pressures are targets beside positions", "[drive]") {
  const SceneDef scene = arm();
  // The root holds what the arm weighs whatever the chambers do, and turns with their bend.
  const Drive d = driven(scene, chambers(), "time,root.moment.y,a.volume\n1,-0.002,1.5e-6\n2,0.001,1.6e-6\n");
  CHECK(d.reason.empty());
  REQUIRE(d.steps.size() == 2);
  const SceneDef again = value(driven_scene(scene, d));
  RunOptions run;
  run.threads = 1;
  const RunResult result = run_scene(again, run);
  REQUIRE(result.status == RunStatus::converged);
  for (std::size_t k = 0; k < 2; ++k) {
    CAPTURE(k, d.steps[k].distance, d.steps[k].position[0], d.steps[k].position[1]);
    CHECK_THAT(result.records[k + 1].reactions[0].moment.y, WithinAbs(d.steps[k].position[0], 1e-7));
    CHECK_THAT(result.records[k + 1].cavities[0].volume, WithinAbs(d.steps[k].position[1], 1e-11));
    CHECK((d.steps[k].reached || d.steps[k].nearest));
  }
}

TEST_CASE("what cannot be driven is refused with file, line and remedy", "[drive]") {
  const SceneDef scene = arm();
  const auto bad = [&](const std::string& text) { return refusal(parse_targets(text, "t.csv", scene)); };
  using Catch::Matchers::Contains;
  CHECK_THAT(bad(""), Contains("t.csv: it is empty"));
  CHECK_THAT(bad("tip.x\n1\n"), Contains("no column \"time\""));
  CHECK_THAT(bad("time\n1\n"), Contains("no target"));
  CHECK_THAT(bad("time,tip.x\n"), Contains("no target"));
  CHECK_THAT(bad("time,tip.w\n1,0\n"), Contains("t.csv, line 1: column 'tip.w'"));
  CHECK_THAT(bad("time,nose.x\n1,0\n"), Contains("no probe 'nose'; it has \"tip\""));
  CHECK_THAT(bad("time,tip.x,tip.x\n1,0,0\n"), Contains("twice"));
  CHECK_THAT(bad("time,tip.x\n1,nan\n"), Contains("line 2: 'nan' is no finite number"));
  CHECK_THAT(bad("time,tip.x\n1,0,3\n"), Contains("3 columns, the header has 2"));
  CHECK_THAT(bad("time,tip.x\n1,0\n1,0\n"), Contains("line 3: time 1 is not after 1"));
  CHECK_THAT(bad("time,tip.x\n0,0\n"), Contains("begins at 0"));
  CHECK(value(parse_targets("\xEF\xBB\xBFtime,\"tip.x\"\r\n1,0\r\n", "t.csv", scene)).time.size() == 1);
  const std::string zeros("time,ti\0p.x\n1,0\n", 17);
  CHECK(bad(zeros).find('\0') == std::string::npos);
  CHECK_THAT(refusal(read_targets("/nowhere.csv", scene)), Contains("cannot be opened"));
  CHECK_THAT(refusal(parse_actuator("a=1")), Contains("LEAST:MOST"));
  CHECK_THAT(refusal(parse_actuator("a=2:1")), Contains("swap"));
  CHECK_THAT(refusal(parse_actuator("a=1:x")), Contains("\"x\" is no number"));
  CHECK_THAT(refusal(parse_actuator("a=0:1:0")), Contains("rate"));
  CHECK(value(parse_actuator("a")).effect == "a");
  const Targets targets = value(parse_targets("time,tip.x\n1,0\n", "t.csv", scene));
  CHECK_THAT(refusal(drive::drive(scene, {}, targets)), Contains("--amount"));
  CHECK_THAT(refusal(drive::drive(scene, {{"d", 0, 1, 1}}, targets)),
             Contains("it has \"root\", \"a\", \"b\", \"c\""));
  CHECK_THAT(refusal(drive::drive(scene, {{"a", 0, 1, 1}}, targets)), Contains("begins at 2000"));
  for (const char* far : {"300", "-1e300"}) {
    const Targets millimeters =
        value(parse_targets(std::string("time,tip.x\n1,") + far + "\n", "t.csv", scene));
    CHECK_THAT(refusal(drive::drive(scene, {{"a", 0, 1e5, 1e5}}, millimeters)), Contains("in meters"));
  }
  CHECK_THAT(refusal(drive::drive(scene, {{"a", 0, 1e4, 1}, {"a", 0, 1e4, 1}}, targets)), Contains("twice"));
  const SceneDef moving = arm({"analysis.type=dynamic"});
  CHECK_THAT(refusal(drive::drive(moving, {{"a", 0, 1e4, 1}}, targets)), Contains("statics"));
}

TEST_CASE("two soft fingers close on a ball until they press with the force asked for", "[drive]") {
  // Bellows of two chambers bend two bars toward each other; friction is part of the way.
  SceneDef scene = value(parse_scene(R"({
    "bodies": [
      {"name": "left", "element": "tet4", "mesh": {"box": {"lower": [-0.032, 0, 0], "upper": [-0.0199, 0.08, 0.01],
       "divisions": [2, 8, 2]}}, "materials": [{"young": 1e5, "poisson": 0.49}]},
      {"name": "right", "element": "tet4", "mesh": {"box": {"lower": [0.0199, 0, 0], "upper": [0.032, 0.08, 0.01],
       "divisions": [2, 8, 2]}}, "materials": [{"young": 1e5, "poisson": 0.49}]}],
    "analysis": {"steps": 3, "duration": 3},
    "dirichlet": [{"name": "palm left", "where": {"body": "left", "surfaces": "y0"}},
                  {"name": "palm right", "where": {"body": "right", "surfaces": "y0"}}],
    "pressures": [{"name": "close left", "body": "left", "surfaces": "x0", "amount": [[0, 0], [1, 600]]},
                  {"name": "close right", "body": "right", "surfaces": "x1", "amount": [[0, 0], [1, 600]]}],
    "contacts": [
      {"name": "grip left", "body": "left", "surfaces": ["x1"], "friction": 0.3,
       "initial_overlap": "resolve",
       "obstacle": {"shape": "sphere", "radius": 0.02, "position": [0, 0.06, 0.005]}},
      {"name": "grip right", "body": "right", "surfaces": ["x0"], "friction": 0.3,
       "initial_overlap": "resolve",
       "obstacle": {"shape": "sphere", "radius": 0.02, "position": [0, 0.06, 0.005]}}]
  })",
                                     "grip", "."));
  const Drive d =
      driven(scene, {{"close left", 0, 5e3}, {"close right", 0, 5e3}},
             "time,grip left.force.x,grip right.force.x\n1,-0.02,0.02\n2,-0.05,0.06\n3,-0.1,0.08\n");
  CHECK(d.reason.empty());
  REQUIRE(d.steps.size() == 3);
  CHECK(d.all_reached());
  const SceneDef again = value(driven_scene(scene, d));
  RunOptions run;
  run.threads = 1;
  const RunResult result = run_scene(again, run);
  REQUIRE(result.status == RunStatus::converged);
  const auto grip = [&](const char* name) {
    for (const Gauge& g : result.records.back().gauges) {
      if (g.effect == name && g.quantity == "force_x") return g.value;
    }
    return 0.0;
  };
  CHECK_THAT(grip("grip left"), WithinAbs(-0.1, 1e-4));
  CHECK_THAT(grip("grip right"), WithinAbs(0.08, 1e-4));
}
