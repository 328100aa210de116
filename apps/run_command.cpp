// run and show: scenes of the library and of files.
#include <chrono>
#include <cstdio>
#include <filesystem>

#include "apps/commands.h"
#include "apps/stop.h"
#include "apps/table.h"
#include "engine/base/base.h"
#include "scenes/library.h"
#include "scenes/run/accuracy.h"
#include "scenes/run/outputs.h"
#include "scenes/run/run.h"
#include "scenes/scene_file.h"

namespace isochor::app {

namespace {

class Progress {
 public:
  void header() const {
    std::printf("%6s %10s %5s %9s %9s %10s %8s %8s %7s\n", "step", "time", "iter", "residual", "rows",
                "vol change", "min J", "elapsed", "ETA");
  }
  void line(const StepRecord& r, int steps) {
    if (r.rejected > 0 || r.work.dual.stand_ins > 0) note_trouble(r);
    const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    const double eta = r.step > 0 ? elapsed / r.step * (steps - r.step) : 0;
    const std::string step = std::to_string(r.step) + "/" + std::to_string(steps);
    std::printf("%6s %10.4g %5d %9.1e %9.1e %8.3f %% %8.4f %8s %7s\n", step.c_str(), r.time,
                r.work.iterations, r.force_residual, r.row_residual, 100 * r.total.volume_change(), r.min_J,
                duration(elapsed).c_str(), duration(eta).c_str());
    std::fflush(stdout);
  }

 private:
  static void note_trouble(const StepRecord& r) {
    std::printf("       (%d increments, %d tried again shorter", r.substeps, r.rejected);
    if (r.work.dual.stand_ins > 0) std::printf(", %d left to another method", r.work.dual.stand_ins);
    std::printf(")\n");
  }
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::string vector_text(const Vec3& v) {
  return number(v.x) + " " + number(v.y) + " " + number(v.z);
}

void print_metrics(const RunResult& r) {
  if (r.metrics.empty()) return;
  Table table({"metric", "value", "unit", "reference", "error", "", "source"});
  table.numbers_from(1, 1);
  for (const MetricValue& m : r.metrics) {
    const bool absolute = m.def.reference && *m.def.reference == 0;
    std::string error = m.error ? (absolute ? number(*m.error, 2) : number(100 * *m.error, 3) + " %") : "";
    if (!m.reached) error = "not reached";
    table.add({m.def.name, number(m.value, 6), m.def.unit, m.def.reference ? number(*m.def.reference, 6) : "",
               error, m.within ? (*m.within ? "ok" : "OUT") : "", m.def.source});
  }
  std::printf("\n%s", table.text("  ").c_str());
}

void print_state(const RunResult& r) {
  if (r.records.empty()) return;
  const StepRecord& end = r.records.back();
  Table table({"at the end", "", ""});
  for (std::size_t p = 0; p < r.probes.size(); ++p) {
    table.add({"probe " + r.probes[p], vector_text(end.probes[p]), "m"});
  }
  for (std::size_t c = 0; c < r.cavities.size(); ++c) {
    table.add({"cavity " + r.cavities[c],
               number(end.cavities[c].pressure) + " Pa, " + number(1e6 * end.cavities[c].volume) + " cm^3",
               ""});
  }
  for (std::size_t s = 0; s < r.supports.size(); ++s) {
    table.add({"reaction " + r.supports[s], vector_text(end.reactions[s].force), "N"});
  }
  for (const VolumeMeasures& p : end.parts) {
    table.add({"volume " + p.name, number(100 * p.volume_change(), 3) + " %",
               "J " + number(p.min_J, 4) + " to " + number(p.max_J, 4)});
  }
  table.add({"volume rows", number(end.volume_row_residual, 2), "left over"});
  table.add({"energy", number(end.total_energy(), 5),
             "J: elastic " + number(end.energy.elastic) + ", kinetic " + number(end.energy.kinetic) +
                 ", of the weight " + number(end.energy.gravity) + ", of loads " +
                 number(end.load_potential())});
  for (const Gauge& g : end.gauges) {
    if (g.kind == "orientation" && g.quantity == "angle")
      table.add({"turn of " + g.effect, number(g.value), g.unit});
  }
  std::printf("\n%s", table.text("  ").c_str());
}

void print_accuracy(const Accuracy& a) {
  if (!a.reason.empty()) {
    std::fprintf(stderr, "isochor: --accuracy: %s\n", a.reason.c_str());
    return;
  }
  const bool limit = a.comparison == Comparison::worse_element;
  Table table(
      {"what it is worth", "value", "unit", limit ? "error at most about" : "error about", "", "compared"});
  table.numbers_from(1, 1);
  for (const AccuracyEntry& e : a.entries) {
    table.add({e.name, number(e.value, 6), e.unit, number(e.indicator, 2),
               e.relative ? number(100 * *e.relative, 2) + " %" : "", number(e.other, 6)});
  }
  std::string places;
  for (const AccuracyEntry& e : a.entries) {
    if (!e.where.empty()) places += "  " + e.where + "\n";
  }
  std::printf(
      "\n%s%s  compared with %s; %.2f s. Without the errors of time steps and of the shape of the mesh.\n",
      table.text("  ").c_str(), places.c_str(), a.how.c_str(), a.seconds);
}

}  // namespace

int exit_code(RunStatus status) {
  switch (status) {
    case RunStatus::converged:
      return success;
    case RunStatus::not_converged:
      return not_converged;
    case RunStatus::budget:
      return out_of_budget;
    case RunStatus::interrupted:
      return interrupted;
    case RunStatus::bad_input:
      return bad_input;
    case RunStatus::not_written:
      return not_written;
    case RunStatus::out_of_memory:
      return out_of_memory;
    case RunStatus::failed:
      break;
  }
  return internal;
}

void print_summary(const RunResult& r, const std::string& folder) {
  print_metrics(r);
  print_state(r);
  std::printf("\n%s: %s, %d Newton iterations, %d factorizations, %.2f s\n", r.scene.c_str(),
              to_string(r.status), r.work.iterations, r.work.factorizations, r.wall_s);
  std::printf("outputs in %s/: index.html, %s.pvd, steps.csv, summary.json\n", folder.c_str(),
              r.scene.c_str());
}

void print_explanation_of(const SceneDef& scene, const RunResult& result) {
  const auto explanation = explain(scene);
  if (explanation)
    print_explanation(explanation.value(), result);
  else
    std::fprintf(stderr, "isochor: --explain: %s\n", explanation.error().c_str());
}

Result<SceneDef> find_scene_named(const std::string& name, const Overrides& overrides) {
  if (const LibraryScene* scene = find_scene(name)) return override_scene(scene->make({}), overrides);
  const bool file = name.ends_with(".json") || name.find('/') != std::string::npos;
  if (file) return read_scene_file(name, overrides);
  std::string known;
  for (const auto& s : scene_library()) known += (known.empty() ? "" : ", ") + std::string(s.name);
  return Error{"there is no scene named \"" + name + "\"; the library has " + known +
               "; a scene file ends in .json"};
}

namespace {

// Says what is wrong; of ranks that find the same the first one. False where no rank found anything.
bool tell(const std::string& trouble, const Ranks* ranks) {
  if (!ranks) {
    if (!trouble.empty()) std::fprintf(stderr, "isochor: %s\n", trouble.c_str());
    return !trouble.empty();
  }
  Hash hash;
  hash.add(std::span<const char>(trouble));
  const auto print = static_cast<double>(hash.value() >> 32);
  double of_root[2] = {ranks->rank() == 0 ? print : 0, trouble.empty() ? 0.0 : 1.0};
  ranks->sum(of_root);
  if (ranks->rank() == 0 && !trouble.empty()) std::fprintf(stderr, "isochor: %s\n", trouble.c_str());
  if (ranks->rank() != 0 && !trouble.empty() && of_root[0] != print)
    std::fprintf(stderr, "isochor: rank %d: %s\n", ranks->rank(), trouble.c_str());
  return of_root[1] > 0;
}

}  // namespace

int run(const RunArguments& a, std::shared_ptr<const Ranks> ranks) {
  auto scene = find_scene_named(a.scene, a.overrides);
  if (tell(scene ? "" : scene.error(), ranks.get())) return bad_input;
  const bool first_rank = !ranks || ranks->rank() == 0;
  if (a.checkpoint) scene.value().outputs.checkpoint_seconds = *a.checkpoint;
  stop_on_signals();
  if (a.price) return price(a, scene.value());
  if (a.error) return run_to_error(a, scene.value());
  const bool tables = !a.quiet && !a.json;
  RunOptions options;
  options.folder = a.folder.empty() ? "out/" + scene.value().name : a.folder;
  options.threads = a.threads;
  options.budget = a.budget;
  options.resume = a.resume;
  options.stop = stop_wanted;
  options.ranks = ranks;
  options.origins = a.accuracy;
  options.log = [&](const std::string& text) {
    if (!a.quiet && first_rank) std::fprintf(stderr, "isochor: note: %s\n", text.c_str());
  };
  Progress progress;
  bool first = true;
  options.on_step = [&](const StepRecord& record, int steps) {
    if (!tables) return;
    if (first) progress.header();
    first = false;
    progress.line(record, steps);
  };
  const RunResult result = run_scene(scene.value(), options);
  if (result.status == RunStatus::bad_input) {
    tell(result.reason, ranks.get());
    return bad_input;
  }
  if (result.ended_before) {
    if (first_rank)
      std::fprintf(stderr, "isochor: note: the run in %s has converged already; there is nothing to resume\n",
                   options.folder.c_str());
    return success;
  }
  std::optional<Accuracy> accuracy;
  if (a.accuracy) {
    accuracy = estimate_accuracy(scene.value(), result, options);
    const std::string summary = summary_json(result, *accuracy);
    if (auto r = write_text((std::filesystem::path(options.folder) / "summary.json").string(), summary); !r)
      std::fprintf(stderr, "isochor: --accuracy: %s\n", r.error().c_str());
    if (a.json) std::fputs(summary.c_str(), stdout);
  } else if (a.json) {
    std::fputs(summary_json(result).c_str(), stdout);
  }
  if (tables) print_summary(result, options.folder);
  if (accuracy && (tables || !accuracy->reason.empty())) print_accuracy(*accuracy);
  if (a.explain) print_explanation_of(scene.value(), result);
  tell(result.reason.empty() ? "" : to_string(result.status) + (": " + result.reason), ranks.get());
  return exit_code(result.status);
}

int show(const std::string& name, const std::vector<std::string>& overrides) {
  auto scene = find_scene_named(name, overrides);
  if (!scene) {
    std::fprintf(stderr, "isochor: %s\n", scene.error().c_str());
    return bad_input;
  }
  std::fputs(to_json(scene.value()).c_str(), stdout);
  return success;
}

}  // namespace isochor::app
