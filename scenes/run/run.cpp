#include "scenes/run/run.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
#include <thread>

#include "engine/base/text.h"
#include "scenes/law_limits.h"
#include "scenes/run/error_places.h"
#include "scenes/run/outputs.h"
#include "scenes/run/step_recorder.h"
#include "scenes/scene_file.h"
#include "scenes/thin_walls.h"

namespace isochor {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Whether it is so on any of the ranks that run together, which must all decide alike.
bool on_any(const RunOptions& options, bool here) {
  if (!options.ranks) return here;
  double count = here ? 1 : 0;
  options.ranks->sum({&count, 1});
  return count > 0;
}

bool is_silent(const RunOptions& options) {
  return options.ranks && options.ranks->rank() != 0;
}

// One run from a built world to its last record.
class Run {
 public:
  Run(const SceneDef& scene, const RunOptions& options, BuiltScene& built, RunResult& result,
      Clock::time_point start)
      : scene_(scene),
        options_(options),
        built_(built),
        result_(result),
        start_(start),
        recorder_(scene, built) {
    result_.wants_origins = options_.origins;
  }

  void describe();
  // Takes over where an earlier run was.
  Result<void> resume(const RunCheckpoint& checkpoint);
  void march(RunOutputs* outputs);
  bool not_written(const std::string& why);  // false

 private:
  bool keeps() const { return scene_.outputs.checkpoint_steps > 0 || scene_.outputs.checkpoint_seconds > 0; }
  void remember(int step, const RunOutputs& outputs);
  bool keep(RunOutputs* outputs);
  bool keep_if_due(RunOutputs* outputs);
  void record(int step, const StepReport& report);
  StepReport advance(double middle, double h);
  // True when the step ended the run.
  bool stopped(const StepReport& report);
  bool out_of_time() const {
    return options_.budget && on_any(options_, seconds_since(start_) > *options_.budget);
  }
  bool stop_asked() const { return on_any(options_, options_.stop && options_.stop()); }
  bool write(RunOutputs* outputs, bool last);
  void warn(const std::string& text);
  void warn_of_ends();

  const SceneDef& scene_;
  const RunOptions& options_;
  BuiltScene& built_;
  RunResult& result_;
  Clock::time_point start_;
  StepRecorder recorder_;
  int doubtful_steps_ = 0;  // that ended with a warning
  bool interrupted_ = false;
  RunCheckpoint complete_;  // as the last complete step left the run, without its records
  int kept_step_ = -1;      // of the last checkpoint written
  Clock::time_point kept_at_ = Clock::now();
  double wall_before_ = 0;  // of the runs that this one resumes [s]
};

void Run::warn(const std::string& text) {
  result_.warnings.push_back(text);
  if (options_.log) options_.log(text);
}

// The first step that ended with a warning is told when it happens; here how many did, and how the run ends.
void Run::warn_of_ends() {
  for (const std::string& finding : recorder_.contact_findings()) warn(finding);
  if (doubtful_steps_ < 2) return;
  const StepRecord& last = result_.records.back();
  std::string text = std::to_string(doubtful_steps_) + " of " + std::to_string(last.step) +
                     " steps ended with such a warning";
  if (!last.warning.empty()) text += "; the last state: " + last.warning;
  warn(text);
}

void Run::describe() {
  const World& world = built_.world;
  result_.size = world.size();
  for (const BodyId id : built_.bodies) result_.elements += world.mesh(id).cell_count();
  name_records(scene_, result_);
  for (const auto& w : world.warnings()) warn(w);
  for (const auto& w : thin_walls(scene_, built_)) warn(w);
  for (const auto& w : recorder_.warnings()) warn(w);
}

void Run::record(int step, const StepReport& report) {
  const World& world = built_.world;
  StepRecord r = recorder_.look(step, report);
  if (!r.warning.empty() && doubtful_steps_++ == 0)
    warn("step " + std::to_string(step) + ", t = " + number(world.time()) + ": " + r.warning);
  recorder_.measure(r);
  result_.records.push_back(std::move(r));
  result_.work += report;
  result_.state_hash = world.state_hash();
  result_.size = world.size();  // the factor is known after the first step
  result_.wall_s = wall_before_ + seconds_since(start_);
  result_.stages += report.seconds;
}

// A step that ends early is no place to go on from: what was never stopped did not end there.
void Run::remember(int step, const RunOutputs& outputs) {
  complete_.step = step;
  complete_.page_bytes = outputs.page_bytes();
  const std::vector<std::byte> state = built_.world.save();
  complete_.state.assign(reinterpret_cast<const char*>(state.data()), state.size());
  complete_.work = result_.work;
  complete_.wall_s = result_.wall_s;
  complete_.stages = result_.stages;
  complete_.warnings = result_.warnings;
}

bool Run::keep(RunOutputs* outputs) {
  if (complete_.step == kept_step_) return true;
  if (complete_.scene.empty()) complete_.scene = to_json(scene_);
  complete_.program = version() + ", " + build_description();
  complete_.records = result_.records;
  while (complete_.records.back().step > complete_.step) complete_.records.pop_back();
  auto r = outputs->keep(complete_);
  complete_.records.clear();
  if (on_any(options_, !r)) return not_written(r ? "rank 0 could not" : r.error());
  kept_step_ = complete_.step;
  kept_at_ = Clock::now();
  return true;
}

bool Run::keep_if_due(RunOutputs* outputs) {
  const OutputDef& o = scene_.outputs;
  const bool by_steps = o.checkpoint_steps > 0 && complete_.step % o.checkpoint_steps == 0;
  const bool by_time =
      o.checkpoint_seconds > 0 && on_any(options_, seconds_since(kept_at_) >= o.checkpoint_seconds);
  return (!by_steps && !by_time) || keep(outputs);
}

Result<void> Run::resume(const RunCheckpoint& c) {
  // As it was in the step that ended there.
  if (c.step > 0) {
    if (auto r = follow_schedule(built_, (c.step - 0.5) * plan_steps(scene_.analysis).h); !r)
      return r.failure();
  }
  if (auto r = built_.world.load(std::as_bytes(std::span(c.state))); !r) return r;
  const std::string program = version() + ", " + build_description();
  result_.resumed_at = c.step;
  result_.records = c.records;
  result_.work = c.work;
  result_.stages = c.stages;
  result_.state_hash = built_.world.state_hash();
  for (const StepRecord& r : c.records) doubtful_steps_ += r.warning.empty() ? 0 : 1;
  for (const std::string& text : c.warnings) {
    const auto& known = result_.warnings;
    if (std::find(known.begin(), known.end(), text) == known.end()) result_.warnings.push_back(text);
  }
  if (c.program != program) {
    warn("the run was begun by isochor " + c.program + " and goes on with " + program +
         ": not to the last bit as if it had not been stopped");
  }
  wall_before_ = result_.wall_s = c.wall_s;
  kept_step_ = c.step;
  return {};
}

bool Run::not_written(const std::string& why) {
  result_.status = RunStatus::not_written;
  result_.reason = "outputs cannot be written: " + why;
  return false;
}

bool Run::stopped(const StepReport& report) {
  switch (report.status) {
    case StepStatus::converged:
      return false;
    case StepStatus::cancelled:
      result_.status = interrupted_ ? RunStatus::interrupted : RunStatus::budget;
      result_.reason = interrupted_ ? "interrupted" : "the time allowed is used up";
      break;
    case StepStatus::unfinished:
    case StepStatus::rejected:
      result_.status = RunStatus::not_converged;
      result_.reason = report.reason;
      if (const std::string limit = law_limit_reached(scene_, built_); !limit.empty())
        result_.reason += "; " + limit;
      break;
    case StepStatus::invalid:
      result_.status = RunStatus::failed;
      result_.reason = report.reason;
      break;
  }
  if (result_.status != RunStatus::not_converged && result_.status != RunStatus::failed) {
    result_.reason += " at t = " + number(built_.world.time());
  }
  return true;
}

// With the effects that are there around `middle`.
StepReport Run::advance(double middle, double h) {
  const auto changed = follow_schedule(built_, middle);
  if (changed) return built_.world.advance(h);
  StepReport refused;
  refused.status = StepStatus::invalid;
  refused.reason = changed.error();
  return refused;
}

bool Run::write(RunOutputs* outputs, bool last) {
  if (!outputs) return true;
  auto r = outputs->record({scene_, built_, result_}, last);
  return !on_any(options_, !r) || not_written(r ? "another rank could not" : r.error());
}

void Run::march(RunOutputs* outputs) {
  const StepPlan plan = plan_steps(scene_.analysis);
  result_.steps_asked = plan.steps;
  World& world = built_.world;
  // Ranks look up together, between steps.
  if (!options_.ranks)
    world.stop_when([this] { return (options_.stop && options_.stop()) || out_of_time(); });
  // Until the last step the summary says what is true: the run is not finished.
  result_.status = RunStatus::interrupted;
  result_.reason = "the run has not ended yet";
  const bool keeping = outputs && keeps();
  if (keeping && result_.resumed_at >= 0) remember(result_.resumed_at, *outputs);
  if (result_.records.empty()) {
    record(0, {});
    if (!write(outputs, false)) return;
    if (keeping) remember(0, *outputs);
  }
  for (int step = result_.records.back().step + 1; step <= plan.steps; ++step) {
    const double before = world.time();
    // A stop between steps must not wait for the next iteration.
    interrupted_ = stop_asked();
    StepReport report;
    report.status = StepStatus::cancelled;
    const auto& path_step = scene_.analysis.path_step;
    if (!interrupted_ && !out_of_time())
      report = path_step ? world.follow(*path_step) : advance((step - 0.5) * plan.h, plan.h);
    interrupted_ = interrupted_ || stop_asked();
    const bool over = stopped(report);
    const bool last = step == plan.steps || (path_step && world.time() >= scene_.analysis.duration);
    if (!over || world.time() != before) {
      record(step, report);
      if (options_.on_step) options_.on_step(result_.records.back(), plan.steps);
    } else {
      result_.work += report;
      result_.stages += report.seconds;
      result_.wall_s = wall_before_ + seconds_since(start_);
    }
    if (!over && last) {
      result_.status = RunStatus::converged;
      result_.reason.clear();
    }
    if (over || last) warn_of_ends();
    if (options_.origins && !over && last) {
      result_.metrics = evaluate_metrics(scene_, result_.records);
      result_.origins = origins_of_answers(scene_, built_, result_);
    }
    if (!write(outputs, over || last)) return;
    if (keeping && over) keep(outputs);
    if (over || last) return;
    if (!keeping) continue;
    remember(step, *outputs);
    if (!keep_if_due(outputs)) return;
  }
}

}  // namespace

const char* to_string(RunStatus status) {
  switch (status) {
    case RunStatus::converged:
      return "converged";
    case RunStatus::not_converged:
      return "not_converged";
    case RunStatus::budget:
      return "budget";
    case RunStatus::interrupted:
      return "interrupted";
    case RunStatus::bad_input:
      return "bad_input";
    case RunStatus::not_written:
      return "not_written";
    case RunStatus::out_of_memory:
      return "out_of_memory";
    case RunStatus::failed:
      break;
  }
  return "failed";
}

namespace {

// The folder's outputs, begun anew or as an earlier run left them. A reason in the result: there are none.
std::optional<RunOutputs> open_outputs(const SceneDef& scene, const RunOptions& options, BuiltScene& built,
                                       Run& run, const std::optional<RunCheckpoint>& checkpoint,
                                       RunResult& result) {
  if (checkpoint) {
    if (auto r = run.resume(*checkpoint); !r) {
      result.reason = options.folder + " cannot be resumed: " + r.error();
      return {};
    }
  }
  auto outputs = is_silent(options) ? Result<RunOutputs>(RunOutputs::silent(options.folder, scene))
                 : checkpoint       ? RunOutputs::reopen(options.folder, {scene, built, result}, *checkpoint)
                                    : RunOutputs::open(options.folder, scene);
  if (!on_any(options, !outputs)) {
    if (options.ranks && options.ranks->size() > 1) outputs.value().share(options.ranks);
    return std::move(outputs).value();
  }
  result.reason = outputs ? "rank 0 cannot write the outputs" : outputs.error();
  return {};
}

// What the run is to go on from; false with a reason in the result: it cannot.
bool find_checkpoint(const SceneDef& scene, const RunOptions& options,
                     std::optional<RunCheckpoint>& checkpoint, RunResult& result) {
  if (options.folder.empty()) {
    result.reason =
        "a run without outputs has nothing to resume; name the folder of the one that was stopped";
    return false;
  }
  auto found = RunOutputs::checkpoint_in(options.folder);
  if (!found) {
    result.reason = found.error();
    return false;
  }
  checkpoint = std::move(found).value();
  if (!checkpoint) {
    if (options.log) options.log(options.folder + " holds no checkpoint: the run begins at the beginning");
    return true;
  }
  const std::string difference = scene_difference(checkpoint->scene, scene);
  if (difference.empty()) return true;
  result.reason = options.folder + " cannot be resumed: it was run with another scene, " + difference +
                  "; give the scene as it was, or run without --resume to begin anew";
  return false;
}

}  // namespace

namespace {

void out_of_memory(const std::string& doing, RunResult& result) {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  result.status = RunStatus::out_of_memory;
  result.reason = "memory ran out while " + doing + ", with " + std::to_string(used.ru_maxrss / 1024) +
                  " MB in use at most; take a coarser mesh or analysis.solver = \"iterative\", or give the "
                  "process more (ulimit -v, limits of the container)";
}

std::string solving(const RunResult& result) {
  const int step = result.records.empty() ? 0 : result.records.back().step + 1;
  return "solving step " + std::to_string(step) + " of " + std::to_string(result.steps_asked) + " for " +
         std::to_string(result.size.displacement_unknowns) + " displacements and " +
         std::to_string(result.size.multipliers) + " multipliers";
}

void run_into(const SceneDef& scene, const RunOptions& options, RunResult& result) {
  const auto start = Clock::now();
  result.scene = scene.name;
  const auto hardware = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  result.threads = options.threads > 0 ? options.threads : hardware;
  if (options.budget && !(*options.budget > 0)) {
    result.reason = "budget = " + number(*options.budget) + " s; it must be positive";
    return;
  }
  std::optional<RunCheckpoint> checkpoint;
  if (options.resume && on_any(options, !find_checkpoint(scene, options, checkpoint, result))) {
    if (result.reason.empty()) result.reason = "another rank cannot read the checkpoint";
    return;
  }
  if (checkpoint && checkpoint->ended) {
    result.status = RunStatus::converged;
    result.ended_before = true;
    return;
  }
  BuildOptions building;
  building.threads = options.threads;
  building.ranks = options.ranks;
  auto built = build(scene, building);
  if (on_any(options, !built)) {
    result.reason = built ? "another rank could not build the scene" : built.error();
    return;
  }
  Run run(scene, options, built.value(), result, start);
  run.describe();
  std::optional<RunOutputs> outputs;
  if (!options.folder.empty()) {
    outputs = open_outputs(scene, options, built.value(), run, checkpoint, result);
    if (!outputs) return;
  }
  try {
    run.march(outputs ? &*outputs : nullptr);
  } catch (const std::bad_alloc&) {
    if (options.ranks) throw;  // the others wait
    out_of_memory(solving(result), result);
  }
  result.metrics = evaluate_metrics(scene, result.records);
  const RunView view{scene, built.value(), result};
  if (outputs && result.status != RunStatus::not_written) {
    auto r = outputs->finish(view);
    if (on_any(options, !r)) run.not_written(r ? "rank 0 could not" : r.error());
  }
  if (outputs && result.status == RunStatus::not_written) outputs->tell_failure(view);
}

}  // namespace

RunResult run_scene(const SceneDef& scene, const RunOptions& options) {
  RunResult result;
  try {
    run_into(scene, options, result);
  } catch (const std::bad_alloc&) {
    if (options.ranks) throw;
    if (result.status != RunStatus::out_of_memory)
      out_of_memory("reading meshes and building the world", result);
  }
  return result;
}

}  // namespace isochor
