#include "studies/chaos/run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

#include "engine/base/text.h"
#include "scenes/scene_file.h"
#include "studies/chaos/scene_judge.h"

namespace isochor::studies {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

// Warnings of a world, and what its last report says beside the numbers.
std::vector<std::string> warnings_of(const World& world, const StepReport& report) {
  std::vector<std::string> said = world.warnings();
  if (!report.warning.empty()) said.push_back(report.warning);
  return said;
}

// What makes a message no sentence for people; empty where nothing does.
std::string unreadable(const std::string& text) {
  if (text.size() > 2000) return "a message has " + std::to_string(text.size()) + " characters";
  std::size_t digits = 0;
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 && c != '\n') return "a message has control characters: " + text;
    digits = c >= '0' && c <= '9' ? digits + 1 : 0;
    if (digits > 20) return "a message has a number of more than twenty digits: " + text;
  }
  return {};
}

// A world before a step: what one that is not taken must leave as it is, results included.
struct Before {
  explicit Before(const World& world)
      : time(world.time()),
        hash(world.state_hash()),
        row(world.constitutive_residual()),
        elastic(world.elastic_energy()) {}
  double time;
  std::uint64_t hash;
  double row, elastic;
};

class ChaosRun {
 public:
  ChaosRun(const SceneDef& scene, const ChaosDrive& drive, BuiltScene& built, ChaosOutcome& out)
      : scene_(scene),
        drive_(drive),
        built_(built),
        out_(out),
        judge_(scene, built),
        plan_(plan_steps(scene.analysis)) {
    out_.asked = plan_.steps;
  }
  void march();

 private:
  StepReport next(World& world, int step);
  bool broken(const std::optional<Finding>& finding);
  bool broken(std::string kind, std::string text) {
    return broken(Finding{std::move(kind), std::move(text)});
  }
  // True when the run is over.
  bool take(const StepReport& report, const Before& before);
  bool reload(int step);
  void compare_reloaded(const StepReport& report, int step);
  void after_budget(const StepReport& report);
  bool budgeted(int step) const {
    return (drive_.budget_iterations > 0 || drive_.budget_seconds > 0) && 2 * step < plan_.steps + 1 &&
           !scene_.analysis.path_step;
  }
  void overshot(double wall, double processor) {
    out_.overshoot = std::max(out_.overshoot, wall);
    // Other work on the machine is not the engine's fault.
    out_.own_overshoot = std::max(out_.own_overshoot, std::min(wall, processor));
  }
  bool timed() const {
    return drive_.budget_seconds > 0 || drive_.wall_seconds > 0 || drive_.cancel_after > 0;
  }

  const SceneDef& scene_;
  const ChaosDrive& drive_;
  std::uint64_t start_ = 0;  // hash of the state at the beginning
  BuiltScene& built_;
  ChaosOutcome& out_;
  SceneJudge judge_;
  StepPlan plan_;
  std::optional<BuiltScene> reloaded_;
  std::uint64_t reloaded_before_ = 0;
  bool unfinished_ = false;
  int reports_ = 0;  // of progress
};

bool ChaosRun::broken(const std::optional<Finding>& finding) {
  if (!finding) return false;
  out_.verdict = ChaosVerdict::broken;
  out_.kind = finding->kind;
  out_.reason =
      "step " + std::to_string(out_.steps) + " of " + std::to_string(out_.asked) + ": " + finding->text;
  return true;
}

StepReport ChaosRun::next(World& world, int step) {
  if (scene_.analysis.path_step) return world.follow(*scene_.analysis.path_step);
  if (budgeted(step)) return world.step(plan_.h, {drive_.budget_iterations, drive_.budget_seconds});
  return drive_.single_increments ? world.step(plan_.h) : world.advance(plan_.h);
}

// Saves the state and loads it into a world of the same scene, which must then be in the same state.
bool ChaosRun::reload(int step) {
  if (step != drive_.reload_after || timed()) return false;
  const auto blob = built_.world.save();
  auto other = build(scene_, {1});
  if (!other) return broken("reload", "the scene cannot be built again: " + other.error());
  if (auto r = other.value().world.load(blob); !r)
    return broken("reload", "its own saved state is refused: " + r.error());
  if (other.value().world.state_hash() != built_.world.state_hash())
    return broken("reload", "a state that was saved and loaded has other bits");
  reloaded_.emplace(std::move(other).value());
  return false;
}

void ChaosRun::compare_reloaded(const StepReport& report, int step) {
  if (!reloaded_) return;
  const StepReport other = next(reloaded_->world, step);
  if (other.status != report.status || reloaded_->world.state_hash() != built_.world.state_hash())
    broken("reload", "a run that was saved and loaded goes on with other bits");
  reloaded_.reset();
}

// A budget must not spoil what comes after it: without one the same steps converge.
void ChaosRun::after_budget(const StepReport& report) {
  if (!unfinished_ || report.status != StepStatus::rejected ||
      report.reason.find("singular") == std::string::npos)
    return;
  auto twin = build(scene_, {1});
  if (!twin) return;
  for (int step = 0; step <= out_.steps; ++step) {
    if (twin.value().world.advance(plan_.h).status != StepStatus::converged) return;
  }
  broken("spoiled by a budget", "after steps with a budget: " + report.reason);
}

bool ChaosRun::take(const StepReport& report, const Before& before) {
  World& world = built_.world;
  out_.iterations += report.iterations;
  const bool stayed = world.time() == before.time;
  if (const std::string why = unreadable(report.reason + " " + report.warning); !why.empty())
    return broken("message", why);
  if (report.status != StepStatus::converged && report.reason.empty())
    return broken("no reason", "a step that did not converge says no reason");
  if (report.status == StepStatus::rejected && report.reason.find("cancelled") != std::string::npos)
    return broken("misreported", "a step that was cancelled is called rejected: " + report.reason);
  if (report.status == StepStatus::unfinished) {
    unfinished_ = true;
    ++out_.steps;
    return broken(judge_.finite(built_)) || broken(judge_.numbers(built_));
  }
  const bool given_back = report.status == StepStatus::rejected && stayed && budgeted(out_.steps);
  if (report.status != StepStatus::converged && stayed) {
    const Before now(world);
    if (now.hash != before.hash)
      return broken("changed state", "a step that was not taken changed the state: " + report.reason);
    if (now.row != before.row || now.elastic != before.elastic) {
      return broken("changed state",
                    "a step that was not taken changed results of the state: residual of rows " +
                        number(before.row) + " to " + number(now.row) + ", elastic energy " +
                        number(before.elastic) + " to " + number(now.elastic) + " J: " + report.reason);
    }
  }
  // In full, to the rounding of its parts.
  const bool whole =
      std::abs(world.time() - before.time - plan_.h) <= 1e-9 * (plan_.h + std::abs(before.time));
  if (report.status == StepStatus::converged && !whole && !scene_.analysis.path_step) {
    return broken("no step", "a step of " + std::to_string(plan_.h) + " converged and the time went from " +
                                 std::to_string(before.time) + " to " + std::to_string(world.time()));
  }
  // What an unfinished step gave back may be the start, which rows need not be met at.
  const bool at_start = report.status != StepStatus::converged && world.state_hash() == start_;
  if (!stayed && !at_start && broken(judge_.accepted(built_, warnings_of(world, report)))) return true;
  if (report.status == StepStatus::converged) {
    ++out_.steps;
    if (out_.warning.empty()) out_.warning = report.warning;
    const SceneJudge::Inversion found = judge_.inversion(world);
    if (found.agrees(report)) return false;
    return broken("measures", "the report says min J " + number(report.min_J) + " and " +
                                  std::to_string(report.inverted_cells) +
                                  " inverted cells, where there are " + number(found.min_J) + " and " +
                                  std::to_string(found.inverted) + " to " +
                                  std::to_string(found.inverted + found.flat));
  }
  if (given_back) {
    // A budget that leaves nothing to keep is no reason why later steps should not go on.
    unfinished_ = true;
    ++out_.steps;
    return false;
  }
  out_.verdict = report.status == StepStatus::invalid ? ChaosVerdict::refused : ChaosVerdict::stopped;
  out_.reason = report.reason;
  after_budget(report);
  return true;
}

void ChaosRun::march() {
  World& world = built_.world;
  const auto start = Clock::now();
  const double processor = processor_seconds();
  if (drive_.cancel_after > 0) {
    world.on_progress([&world, this](const ProgressInfo&) {
      if (++reports_ == drive_.cancel_after) world.cancel();
    });
  }
  if (drive_.wall_seconds > 0) {
    const auto late = [&] { return seconds_since(start) > drive_.wall_seconds; };
    if (drive_.cancels) {
      world.on_progress([&world, late](const ProgressInfo&) {
        if (late()) world.cancel();
      });
    } else {
      world.stop_when(late);
    }
  }
  out_.verdict = ChaosVerdict::solved;
  start_ = world.state_hash();
  for (int step = 0; step < plan_.steps; ++step) {
    if (reload(step)) return;
    const Before before(world);
    if (drive_.cancels && drive_.wall_seconds > 0 && seconds_since(start) > drive_.wall_seconds)
      world.cancel();
    const auto step_start = Clock::now();
    const double step_processor = processor_seconds();
    const StepReport report = next(world, step);
    if (budgeted(step) && drive_.budget_seconds > 0)
      overshot(seconds_since(step_start) - drive_.budget_seconds,
               processor_seconds() - step_processor - drive_.budget_seconds);
    if (drive_.wall_seconds > 0)
      overshot(seconds_since(start) - drive_.wall_seconds,
               processor_seconds() - processor - drive_.wall_seconds);
    // Sweeps are of a fixed number.
    const bool sweeps = scene_.analysis.options.method == Method::position_based;
    const int allowed = sweeps ? 0 : drive_.budget_iterations;
    if (budgeted(step) && allowed > 0 && report.iterations > allowed) {
      broken("overshoot",
             std::to_string(report.iterations) + " iterations within a budget of " + std::to_string(allowed));
      return;
    }
    const bool over = take(report, before);
    const SceneJudge::Inversion found = judge_.inversion(world);
    out_.min_J = found.min_J;
    out_.inverted = static_cast<long>(found.inverted);
    if (out_.verdict == ChaosVerdict::broken) return;
    compare_reloaded(report, step);
    if (over || out_.verdict == ChaosVerdict::broken) return;
    if (scene_.analysis.path_step && world.time() >= scene_.analysis.duration) break;
  }
  if (!out_.warning.empty()) {
    out_.verdict = ChaosVerdict::told;
    out_.reason = out_.warning;
  }
}

// The same seed with iterations in place of seconds, so that it does the same on every machine.
ChaosDrive without_clock(const ChaosScene& chaos) {
  ChaosDrive drive = chaos.drive;
  if (drive.budget_seconds > 0) drive.budget_iterations = static_cast<int>(1 + chaos.seed % 4);
  if (drive.wall_seconds > 0) drive.cancel_after = static_cast<int>(1 + chaos.seed % 40);
  drive.budget_seconds = drive.wall_seconds = 0;
  return drive;
}

}  // namespace

const char* to_string(ChaosVerdict verdict) {
  constexpr const char* kWords[] = {"solved", "told", "refused", "stopped", "broken"};
  return kWords[static_cast<std::size_t>(verdict)];
}

ChaosOutcome run_chaos_scene(const ChaosScene& chaos, const ChaosRunOptions& options) {
  const auto start = Clock::now();
  ChaosOutcome out;
  out.seed = chaos.seed;
  const auto scene = write_chaos_scene(chaos, options.folder);
  const auto refuse = [&](const std::string& message) {
    const std::string why = unreadable(message);
    const bool good = !message.empty() && why.empty();
    out.verdict = good ? ChaosVerdict::refused : ChaosVerdict::broken;
    out.kind = good ? "" : (message.empty() ? "no reason" : "message");
    out.reason = why.empty() ? message : why;
    out.seconds = seconds_since(start);
    return out;
  };
  if (!scene && check_scene(chaos.scene)) {
    out.kind = "scene file";
    out.reason = "a scene that was written cannot be read: " + scene.error();
    return out;
  }
  if (!scene) return refuse(scene.error());
  if (to_json(scene.value()) != to_json(chaos.scene)) {
    out.kind = "scene file";
    out.reason = "a scene that was written and read is another one";
    return out;
  }
  auto built = build(scene.value(), {1});
  if (!built) return refuse(built.error());
  const ChaosDrive drive = options.judge_time ? chaos.drive : without_clock(chaos);
  ChaosRun(scene.value(), drive, built.value(), out).march();
  out.seconds = seconds_since(start);
  if (options.judge_time && out.own_overshoot > 1 && out.verdict != ChaosVerdict::broken) {
    out.verdict = ChaosVerdict::broken;
    out.kind = "overshoot";
    out.reason = "a budget was overshot by " + std::to_string(out.overshoot) + " s, " +
                 std::to_string(out.own_overshoot) + " s of them its own processor time";
  }
  return out;
}

}  // namespace isochor::studies
