// An answer within an error that is asked for, at the least predicted cost: which element, on which mesh.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scenes/run/accuracy.h"
#include "scenes/run/run.h"
#include "scenes/run/setting.h"

namespace isochor {

// One run on the way.
struct Trial {
  Setting setting;
  RunStatus status = RunStatus::bad_input;
  std::string reason;  // why it did not converge
  Index elements = 0, unknowns = 0;
  double seconds = 0, predicted_seconds = 0;  // predicted 0: there was nothing to predict from
  std::optional<double> indicator;            // the largest of all metrics and probes, relative
  // Of scenes whose steps matter: the part of the mesh and element, and of the steps, each the largest of
  // all; the mesh has none where the run is one of those that tell of the steps.
  std::optional<double> of_mesh, of_steps;
  std::string held_by, how;  // whose it is, and how it is known
};

enum class SearchEnd : std::uint8_t {
  reached,
  not_reached,  // within the levels and the memory there are
  budget,       // the time allowed is used up, or what is left is too short for the next run
  interrupted,
  bad_input,
  not_written,
  failed,  // no run converged
};
// Here, so that summaries do not bring the search with them: hosts without files have none.
inline const char* to_string(SearchEnd end) {
  switch (end) {
    case SearchEnd::reached:
      return "reached";
    case SearchEnd::not_reached:
      return "not_reached";
    case SearchEnd::budget:
      return "budget";
    case SearchEnd::interrupted:
      return "interrupted";
    case SearchEnd::bad_input:
      return "bad_input";
    case SearchEnd::not_written:
      return "not_written";
    case SearchEnd::failed:
      break;
  }
  return "failed";
}

struct ErrorSearchOptions {
  double error = 0.01;  // relative, of every metric and probe
  int most_levels =
      4;           // of refinement beyond the scene's mesh; three times as many where some cells are refined
  RunOptions run;  // the budget is that of all runs together; outputs are those of the best run
  std::function<void(const Trial&)> on_trial;
};

struct ErrorSearch {
  SearchEnd end = SearchEnd::bad_input;
  std::string sentence;  // how the answer is known, or why there is none
  double asked = 0;
  std::vector<Trial> trials;
  std::optional<std::size_t> best;  // of the trials; none: no run converged
  SceneDef scene;                   // of the best
  std::string overrides;            // what makes the best out of the scene
  RunResult result;                 // of the best, or of the last that was tried
  Accuracy accuracy;                // of the best
  double seconds = 0;               // of all runs
};

// Runs settings until one is known to be good enough: first the cheap elements on the mesh of the scene, then
// always what is expected to reach the error at the least predicted cost: a better element, all cells cut
// into eight, or those cells alone that hold three quarters of the error of every answer. Ctrl-C and the
// budget leave the best so far, with its outputs.
ErrorSearch search_error(const SceneDef& scene, const ErrorSearchOptions& options);

// A percentage as "1%" or "1 %", or a fraction as "0.01".
Result<double> parse_error_demand(const std::string& text);

// summary.json of the best run, with the indicators and the trials under "accuracy".
std::string summary_json(const ErrorSearch& search);

}  // namespace isochor
