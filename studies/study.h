// Studies: sweeps of scenes with their measurements, tables and diagrams, each declared once.
//
// A study is a list of cells, each a scene to run, and a way to present what they measured. run_study() of
// run_study.h measures the cells and keeps them in a folder, so that a study that was stopped goes on where
// it was.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/run/run.h"
#include "studies/page.h"

namespace isochor::studies {

using Numbers = std::map<std::string, double>;
using Labels = std::map<std::string, std::string>;

// What a cell that is more than a run measures: named numbers, or why it cannot.
using Probe = std::function<Result<Numbers>(const SceneDef& scene, int threads)>;

// One run of a sweep.
struct Cell {
  std::string id;      // unique in the study and the same in every run of it: "cook/tet10_node/2"
  Labels labels;       // "problem", "formulation", "level", "solver": what tables and diagrams group by
  Numbers knobs;       // numbers of the sweep: "nu", "tolerance", "step"
  SceneDef scene;      // what is run
  std::string metric;  // the metric of the scene that is held against the reference; empty: none
  std::optional<double> reference;
  std::string source;      // where the reference is from
  double uncertainty = 0;  // of the reference, relative: errors below it mean nothing
  int threads = 0;         // 0: as the study is run
  Probe probe;             // runs instead of the scene where given
  bool outputs = false;    // write its outputs, and count their time
  bool guarded = false;    // held against committed expectations by `study --check`
};

// What one cell gave. Everything but the seconds repeats exactly on one build and machine.
struct Measured {
  std::string id, fingerprint;
  Labels labels;
  Numbers knobs;
  std::string status = "failed",
              reason;  // status as of RunStatus; "converged" also for a probe that succeeded
  Numbers values;      // metrics of the scene by name, or what the probe gave
  std::optional<double> value, reference, error;  // of the cell's metric; error: relative, not negative
  double uncertainty = 0;
  std::string source;
  std::int64_t elements = 0, nodes = 0, displacements = 0, multipliers = 0;
  std::int64_t nonzeros = 0, factor_nonzeros = 0, engine_bytes = 0;
  int steps = 0, iterations = 0, factorizations = 0, solves = 0, threads = 0;
  // Wall time of the run from reading the mesh to its last step, without outputs: least and median of
  // `repeats` runs after one that is not counted.
  int repeats = 0;
  double seconds = 0, seconds_median = 0;
  double cpu_seconds = 0;  // least, of all threads: what a busy machine does not stretch
  StageSeconds stages;     // of the fastest run
  std::string hash;        // of the last state

  bool good() const { return status == "converged"; }
  std::string label(const std::string& key) const {
    const auto it = labels.find(key);
    return it == labels.end() ? std::string() : it->second;
  }
  double knob(const std::string& key) const {
    const auto it = knobs.find(key);
    return it == knobs.end() ? 0.0 : it->second;
  }
  double number(const std::string& key) const;  // of `values`; NaN where it is missing
  double unknowns() const { return static_cast<double>(displacements + multipliers); }
};

struct Study {
  std::string_view name, title;
  std::string_view question;  // what it answers, in a sentence
  std::vector<Cell> (*cells)(bool quick);
  // Sections of the page, in order. Cells that failed or have not run are in the list with their status or
  // absent from it.
  std::vector<Section> (*present)(std::span<const Measured> cells);
  int repeats = 3;  // timed runs a cell; with --quick one
};

std::span<const Study> studies();
const Study* find_study(std::string_view name);

// One a file in studies/declarations.
Study accuracy_study();
Study locking_study();
Study solvers_study();
Study timesteps_study();
Study effects_study();
Study scaling_study();
Study stability_study();
Study zones_study();
Study pressure_study();
Study stabilization_study();
Study references_study();
Study papers_study();

}  // namespace isochor::studies
