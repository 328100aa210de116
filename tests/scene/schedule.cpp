// Effects that begin and end while a scene runs.
#include "scenes/schedule.h"

#include <cmath>

#include "engine/base/base.h"
#include "scene/small_scene.h"
#include "support/worlds.h"

using namespace isochor;
using namespace isochor::test;
using Catch::Matchers::Contains;

namespace {

// A block that hangs from its wall; `schedule` is the text of the list.
std::string text(const std::string& schedule, const std::string& more = "") {
  return R"({
    "name": "hung",
    "bodies": [{"name": "block", "mesh": {"box": {"upper": [2, 1, 1], "divisions": [2, 1, 1]}},
                "materials": [{"young": 1000, "poisson": 0.5}]}],
    "analysis": {"steps": 8, "duration": 2},
    "dirichlet": [{"name": "wall", "where": {"surfaces": "x0"}},
                  {"name": "grip", "where": {"surfaces": "x1"}, "displacement": [0.2, 0, 0], "amount": [[0, 1]]}],
    "tractions": [{"name": "pull", "surface": "x1", "traction": [50, 0, 0], "amount": [[0, 1]]}],
    "cables": [{"name": "cord", "points": [[0, 0.5, 0.5], [2, 0.5, 0.5]], "control": "length", "stiffness": 500,
                "amount": [[0, 1.9]]}],
    "probes": [{"name": "tip", "point": [2, 0.5, 0.5]}],)" +
         more + R"("schedule": )" + schedule + "}";
}

SceneDef scene(const std::string& schedule, const std::string& more = "") {
  auto made = parse_scene(text(schedule, more), "hung.json", ".");
  INFO((made ? std::string() : made.error()));
  REQUIRE(made);
  return made.value();
}

RunResult run(const SceneDef& s) {
  RunResult r = run_scene(s);
  INFO(r.reason);
  CHECK(r.status == RunStatus::converged);
  return r;
}

double tip(const RunResult& r, int step) {
  return r.records.at(static_cast<std::size_t>(step)).probes[0].x;
}

std::string refusal(const std::string& schedule, const std::string& more = "") {
  auto made = parse_scene(text(schedule, more), "hung.json", ".");
  if (!made) return made.error();
  const auto built = build(made.value());
  REQUIRE(!built);
  return built.error();
}

}  // namespace

TEST_CASE("effects are there in the steps between their times and in no others") {
  // The grip holds from 0.5 to 1.25, the load is there to 1 and again from 1.5 on.
  const RunResult r = run(scene(R"([{"effects": "grip", "from": 0.5, "to": 1.25},
                                    {"effects": ["pull"], "to": 1}, {"effects": "pull", "from": 1.5},
                                    {"effects": "cord", "from": 5}])"));
  const RunResult pulled = run(scene(R"([{"effects": ["grip", "cord"], "from": 5}])"));
  const double by_load = tip(pulled, 1);
  REQUIRE(by_load > 0.01);
  CHECK(tip(r, 1) == Approx(by_load));
  CHECK(tip(r, 2) == Approx(by_load));
  for (const int held : {3, 4, 5}) CHECK(tip(r, held) == Approx(0.2).margin(1e-12));
  CHECK(std::abs(tip(r, 6)) < 1e-9);  // neither
  CHECK(tip(r, 7) == Approx(by_load));
  CHECK(tip(r, 8) == Approx(by_load));
  // What holds nothing has no reaction.
  CHECK(norm(r.records[2].reactions[1].force) == 0);
  CHECK(norm(r.records[4].reactions[1].force) > 1);
}

TEST_CASE("a scene whose schedule leaves everything there has the bits of one without") {
  const std::string always = R"([{"effects": ["grip"], "from": 0}])",
                    cord = R"([{"effects": "cord", "from": 0}])";
  SceneDef plain = scene(always);
  plain.schedule.clear();
  const RunResult a = run(plain);
  CHECK(a.state_hash == run(scene(always)).state_hash);
  CHECK(a.state_hash == run(scene(cord)).state_hash);
}

TEST_CASE("gauges of effects that are not there have no number, and every record the same columns") {
  const RunResult r =
      run(scene(R"([{"effects": "grip", "from": 5}, {"effects": "cord", "from": 1, "to": 1.5}])",
                R"("metrics": [{"name": "held", "quantity": "cable_tension", "of": "cord", "time": 1.5}],)"));
  REQUIRE(r.metrics.size() == 1);
  CHECK(r.metrics[0].value > 0);
  const auto tension = [&](int step) {
    const auto& gauges = r.records.at(static_cast<std::size_t>(step)).gauges;
    for (const Gauge& g : gauges) {
      if (g.effect == "cord" && g.quantity == "tension") return g.value;
    }
    FAIL("no column");
    return 0.0;
  };
  for (const StepRecord& record : r.records) CHECK(record.gauges.size() == r.records[0].gauges.size());
  CHECK(std::isnan(tension(0)));
  CHECK(std::isnan(tension(4)));
  CHECK(tension(5) > 0);
  CHECK(tension(6) == Approx(r.metrics[0].value));
  CHECK(std::isnan(tension(7)));
}

TEST_CASE("a run that is resumed between two changes ends with the bits of one that was not stopped") {
  SceneDef s = scene(R"([{"effects": "grip", "from": 0.5, "to": 1.25}, {"effects": "cord", "from": 1}])");
  s.outputs.every = 0;
  s.outputs.page = false;
  s.outputs.checkpoint_steps = 1;
  const RunResult whole = run(s);
  for (const int stop_after : {1, 2, 3, 5, 6}) {
    const Scratch folder("schedule");
    RunOptions options;
    options.folder = folder.string();
    int steps = 0;
    options.on_step = [&](const StepRecord& r, int) { steps = r.step; };
    options.stop = [&] { return steps >= stop_after; };
    CHECK(run_scene(s, options).status == RunStatus::interrupted);
    options.stop = {};
    options.resume = true;
    const RunResult rest = run_scene(s, options);
    INFO("stopped after " << stop_after << ": " << rest.reason);
    CHECK(rest.status == RunStatus::converged);
    CHECK(rest.resumed_at >= stop_after);
    CHECK(rest.state_hash == whole.state_hash);
  }
}

TEST_CASE("what a schedule cannot mean is refused before anything runs") {
  CHECK_THAT(refusal(R"([{"effects": "grap"}])"),
             Contains("schedule[0].effects: there is no effect \"grap\""));
  CHECK_THAT(refusal(R"([{"effects": []}])"), Contains("schedule[0].effects is empty"));
  CHECK_THAT(refusal(R"([{"from": 1}])"), Contains("effects"));
  CHECK_THAT(refusal(R"([{"effects": "grip", "from": 0.3}])"),
             Contains("schedule[0].from = 0.3 is not the end of a step"));
  CHECK_THAT(refusal(R"([{"effects": "grip", "to": 0.3}])"),
             Contains("schedule[0].to = 0.3 is not the end of a step"));
  CHECK_THAT(refusal(R"([{"effects": "grip", "from": 1, "to": 0.5}])"), Contains("to comes after it"));
  CHECK_THAT(refusal(R"([{"effects": "rows"}])", R"("volumes": [{"name": "rows"}],)"),
             Contains("\"rows\" is one of volumes, which are there from the beginning"));
  // Without its wall the block would float, at 1.5 and not before.
  CHECK_THAT(refusal(R"([{"effects": "wall", "to": 1.5}, {"effects": "grip", "to": 1}])"),
             Contains("schedule, at t = 1.5"));
}

TEST_CASE("schedules are written as they are read, and worlds of hosts do not follow them") {
  const SceneDef s =
      scene(R"([{"effects": ["grip", "pull"], "from": 0.25, "to": 1}, {"effects": "cord", "from": 2}])");
  const auto again = parse_scene(to_json(s), "again.json", ".");
  REQUIRE(again);
  CHECK(to_json(again.value()) == to_json(s));
  CHECK(again.value().schedule.size() == 2);
  const auto refused = no_schedule(s, "a world of a scene");
  REQUIRE(!refused);
  CHECK_THAT(refused.error(), Contains("schedule"));
  CHECK(no_schedule(small_scene(), "drive"));
}
