#include "scenes/run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "engine/text.h"
#include "scenes/contact_watch.h"
#include "scenes/outputs.h"
#include "scenes/probes.h"

namespace isochor {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void add(StageTimes& sum, const StageTimes& t) {
  sum.analyze += t.analyze;
  sum.evaluate += t.evaluate;
  sum.gather += t.gather;
  sum.factor += t.factor;
  sum.solve += t.solve;
  sum.line_search += t.line_search;
  sum.total += t.total;
}

// One run from a built world to its last record.
class Run {
 public:
  Run(const SceneDef& scene, const RunOptions& options, BuiltScene& built, RunResult& result,
      Clock::time_point start)
      : scene_(scene), options_(options), built_(built), result_(result), start_(start) {}

  void describe();
  void locate_probes();
  void march(RunOutputs* outputs);

 private:
  void record(int step, const StepReport& report);
  // True when the step ended the run.
  bool stopped(const StepReport& report);
  bool out_of_time() const { return options_.budget && seconds_since(start_) > *options_.budget; }
  bool write(RunOutputs* outputs, bool last);
  void warn(const std::string& text);
  void warn_of_ends();

  const SceneDef& scene_;
  const RunOptions& options_;
  BuiltScene& built_;
  RunResult& result_;
  Clock::time_point start_;
  std::vector<MaterialPoint> probes_;
  ContactWatch contacts_;
  int doubtful_steps_ = 0;  // that ended with a warning
  bool interrupted_ = false;
};

void Run::warn(const std::string& text) {
  result_.warnings.push_back(text);
  if (options_.log) options_.log(text);
}

// The first step that ended with a warning is told when it happens; here how many did, and how the run ends.
void Run::warn_of_ends() {
  for (const std::string& finding : contacts_.findings()) warn(finding);
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
  for (const auto& p : scene_.probes) result_.probes.push_back(p.name);
  for (const auto& c : scene_.cavities) result_.cavities.push_back(c.name);
  for (const auto& d : scene_.dirichlet) result_.supports.push_back(d.name);
  for (const auto& w : world.warnings()) warn(w);
}

void Run::locate_probes() {
  for (const ProbeDef& p : scene_.probes) {
    const BodyId id = built_.bodies[static_cast<std::size_t>(p.body)];
    probes_.push_back(locate(built_.world.mesh(id), p.point));
    if (probes_.back().distance == 0) continue;
    const Vec3 X = built_.world.rest_positions(id)[static_cast<std::size_t>(probes_.back().nodes[0])];
    warn("probe \"" + p.name + "\" lies in no cell; it follows the nearest node, at (" + std::to_string(X.x) +
         ", " + std::to_string(X.y) + ", " + std::to_string(X.z) + "), " +
         std::to_string(probes_.back().distance) + " m away");
  }
}

void Run::record(int step, const StepReport& report) {
  const World& world = built_.world;
  StepRecord r;
  r.step = step;
  r.time = world.time();
  r.iterations = report.iterations;
  r.substeps = report.substeps;
  r.rejected = report.rejected_substeps;
  r.stand_ins = report.stand_ins;
  r.factorizations = report.factorizations;
  r.force_residual = report.force_residual;
  r.row_residual = report.row_residual;
  r.seconds = report.seconds.total;
  r.constitutive_residual = world.constitutive_residual();
  r.inverted_cells = report.inverted_cells;
  r.warning = report.warning;
  if (!r.warning.empty() && doubtful_steps_++ == 0)
    warn("step " + std::to_string(step) + ", t = " + number(world.time()) + ": " + r.warning);
  r.min_J = INFINITY;
  r.max_J = -INFINITY;
  for (const BodyId id : built_.bodies) {
    const BodyMeasures m = world.measures(id);
    r.volume_error = std::max(r.volume_error, m.volume_error);
    r.min_J = std::min(r.min_J, m.min_J);
    r.max_J = std::max(r.max_J, m.max_J);
  }
  r.elastic_energy = world.elastic_energy();
  r.kinetic_energy = world.kinetic_energy();
  for (std::size_t p = 0; p < probes_.size(); ++p) {
    const BodyId id = built_.bodies[static_cast<std::size_t>(scene_.probes[p].body)];
    r.probes.push_back(probes_[p].at(world.positions(id)) - probes_[p].at(world.rest_positions(id)));
  }
  r.cavities.resize(scene_.cavities.size());
  const std::vector<Gauge> gauges = world.gauges();
  contacts_.look(r.time, gauges);
  for (const Gauge& g : gauges) {
    const bool of_chamber = g.kind == "cavity" && (g.quantity == "pressure" || g.quantity == "volume");
    if (!of_chamber) r.gauges.push_back(g);
    for (std::size_t c = 0; c < scene_.cavities.size(); ++c) {
      if (!of_chamber || g.effect != scene_.cavities[c].name) continue;
      (g.quantity == "pressure" ? r.cavities[c].pressure : r.cavities[c].volume) = g.value;
    }
  }
  if (scene_.analysis.path_step) {
    r.gauges.push_back(
        {"path", "equilibrium", "unstable directions", "", static_cast<double>(report.unstable_directions)});
  }
  for (const EffectId id : built_.dirichlet) {
    const auto [force, moment] = world.reaction(id);
    r.reactions.push_back({force, moment});
  }
  result_.records.push_back(std::move(r));
  result_.newton_iterations += report.iterations;
  result_.factorizations += report.factorizations;
  result_.solves += report.iterations + report.corrections;
  result_.state_hash = world.state_hash();
  result_.size = world.size();  // the factor is known after the first step
  result_.wall_s = seconds_since(start_);
  add(result_.stages, report.seconds);
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

bool Run::write(RunOutputs* outputs, bool last) {
  if (!outputs) return true;
  auto r = outputs->record({scene_, built_, result_}, last);
  if (r) return true;
  result_.status = RunStatus::failed;
  result_.reason = "outputs cannot be written: " + r.error();
  return false;
}

void Run::march(RunOutputs* outputs) {
  const StepPlan plan = plan_steps(scene_.analysis);
  result_.steps_asked = plan.steps;
  World& world = built_.world;
  world.stop_when([this] { return (options_.stop && options_.stop()) || out_of_time(); });
  // Until the last step the summary says what is true: the run is not finished.
  result_.status = RunStatus::interrupted;
  result_.reason = "the run has not ended yet";
  record(0, {});
  if (!write(outputs, false)) return;
  for (int step = 1; step <= plan.steps; ++step) {
    const double before = world.time();
    // A stop between steps must not wait for the next iteration.
    interrupted_ = options_.stop && options_.stop();
    StepReport report;
    report.status = StepStatus::cancelled;
    const auto& path_step = scene_.analysis.path_step;
    if (!interrupted_ && !out_of_time())
      report = path_step ? world.follow(*path_step) : world.advance(plan.h);
    interrupted_ = interrupted_ || (options_.stop && options_.stop());
    const bool over = stopped(report);
    const bool last = step == plan.steps || (path_step && world.time() >= scene_.analysis.duration);
    if (!over || world.time() != before) {
      record(step, report);
      if (options_.on_step) options_.on_step(result_.records.back(), plan.steps);
    } else {
      result_.newton_iterations += report.iterations;
      result_.factorizations += report.factorizations;
      result_.solves += report.iterations + report.corrections;
      add(result_.stages, report.seconds);
    }
    if (!over && last) {
      result_.status = RunStatus::converged;
      result_.reason.clear();
    }
    if (over || last) warn_of_ends();
    if (!write(outputs, over || last) || over || last) return;
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
    case RunStatus::failed:
      break;
  }
  return "failed";
}

RunResult run_scene(const SceneDef& scene, const RunOptions& options) {
  const auto start = Clock::now();
  RunResult result;
  result.scene = scene.name;
  const auto hardware = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  result.threads = options.threads > 0 ? options.threads : hardware;
  if (options.budget && !(*options.budget > 0)) {
    result.reason = "budget = " + std::to_string(*options.budget) + " s; it must be positive";
    return result;
  }
  auto built = build(scene, {options.threads});
  if (!built) {
    result.reason = built.error();
    return result;
  }
  std::optional<RunOutputs> outputs;
  if (!options.folder.empty()) {
    auto opened = RunOutputs::open(options.folder, scene);
    if (!opened) {
      result.reason = opened.error();
      return result;
    }
    outputs.emplace(std::move(opened).value());
  }
  Run run(scene, options, built.value(), result, start);
  run.describe();
  run.locate_probes();
  run.march(outputs ? &*outputs : nullptr);
  result.metrics = evaluate_metrics(scene, result.records);
  result.wall_s = seconds_since(start);
  if (outputs && result.status != RunStatus::failed) {
    if (auto r = outputs->finish({scene, built.value(), result}); !r) {
      result.status = RunStatus::failed;
      result.reason = "outputs cannot be written: " + r.error();
    }
  }
  return result;
}

}  // namespace isochor
