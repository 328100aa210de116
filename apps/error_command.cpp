// run --error: element and mesh for an error that is asked for.
#include <cmath>
#include <cstdio>

#include "apps/commands.h"
#include "apps/stop.h"
#include "apps/table.h"
#include "scenes/run/error_search.h"

namespace isochor::app {

namespace {

std::string percent(double relative) {
  return std::isfinite(relative) ? number(100 * relative, 2) + " %" : "unknown";
}

void print_entries(const ErrorSearch& s) {
  if (s.accuracy.entries.empty()) return;
  Table table({"what it is worth", "value", "unit", "error at most about", "", "compared"});
  table.numbers_from(1, 1);
  for (const AccuracyEntry& e : s.accuracy.entries) {
    table.add({e.name, number(e.value, 6), e.unit, number(e.indicator, 2),
               e.relative ? percent(*e.relative) : "", number(e.other, 6)});
  }
  std::printf("\n%s  Without the error of the shape of the mesh.\n", table.text("  ").c_str());
}

// What the scene was changed by on the command line.
std::string given(const RunArguments& a) {
  std::string out;
  for (const std::string& o : a.overrides) out += " --set '" + o + "'";
  return out;
}

int code_of(const ErrorSearch& s) {
  switch (s.end) {
    case SearchEnd::reached:
      return success;
    case SearchEnd::not_reached:
      return not_converged;
    case SearchEnd::budget:
      return out_of_budget;
    case SearchEnd::interrupted:
      return interrupted;
    case SearchEnd::bad_input:
      return bad_input;
    case SearchEnd::not_written:
      return not_written;
    case SearchEnd::failed:
      break;
  }
  return s.trials.empty() ? internal : exit_code(s.trials.back().status);
}

}  // namespace

void print_trial(const Trial& t) {
  std::string found;
  if (t.status != RunStatus::converged)
    found = std::string(to_string(t.status)) + ": " + t.reason;
  else if (t.indicator)
    found = "within " + percent(*t.indicator) + " (" + t.held_by + ")";
  else if (t.of_steps)
    found = "steps within " + percent(*t.of_steps) + " (" + t.held_by + ")";
  else
    found = "nothing to compare with yet";
  if (t.of_mesh) found += ", the mesh " + percent(*t.of_mesh);
  std::printf("  %-58s %8d unknowns %8s  %s\n", describe(t.setting).c_str(), t.unknowns,
              duration(t.seconds).c_str(), found.c_str());
  std::fflush(stdout);
}

int run_to_error(const RunArguments& a, const SceneDef& scene) {
  const auto error = parse_error_demand(*a.error);
  if (!error) return refuse("--" + error.error());
  const bool tables = !a.quiet && !a.json;
  ErrorSearchOptions options;
  options.error = error.value();
  options.run.folder = a.folder.empty() ? "out/" + scene.name : a.folder;
  options.run.threads = a.threads;
  options.run.budget = a.budget;
  options.run.stop = stop_wanted;
  options.on_trial = [&](const Trial& t) {
    if (tables) print_trial(t);
  };
  const ErrorSearch search = search_error(scene, options);
  if (!search.best) {
    std::fprintf(stderr, "isochor: --error: %s\n", search.sentence.c_str());
    return code_of(search);
  }
  for (const std::string& w : search.result.warnings) {
    if (!a.quiet) std::fprintf(stderr, "isochor: note: %s\n", w.c_str());
  }
  if (a.json) std::fputs(summary_json(search).c_str(), stdout);
  if (tables) {
    print_summary(search.result, options.run.folder);
    print_entries(search);
    if (!search.overrides.empty())
      std::printf("  the same alone: isochor run %s%s %s\n", a.scene.c_str(), given(a).c_str(),
                  search.overrides.c_str());
    std::printf("\n%s: %s; %s in all\n", scene.name.c_str(), search.sentence.c_str(),
                duration(search.seconds).c_str());
    if (a.explain) print_explanation_of(search.scene, search.result);
  }
  if (search.end != SearchEnd::reached)
    std::fprintf(stderr, "isochor: --error: %s: %s\n", to_string(search.end), search.sentence.c_str());
  return code_of(search);
}

}  // namespace isochor::app
