// Runs a scene: the same for the command line, the tests, the studies and the pages of the documentation.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "scenes/scene.h"

namespace isochor {

struct CavityState {
  double pressure = 0;  // [Pa]
  double volume = 0;    // [m^3]
};
struct Reaction {
  Vec3 force{};   // [N]
  Vec3 moment{};  // about the origin [N m]
};

// What is known after a step; the first record is the rest state.
struct StepRecord {
  int step = 0;
  double time = 0;  // [s], or load factor
  SolveCounters work;
  int substeps = 0, rejected = 0;
  double force_residual = 0, row_residual = 0, constitutive_residual = 0;
  // What the volume rows leave over, the largest of all bodies; says nothing of volume that a compressible
  // body has lost, see `total` and `parts`.
  double volume_row_residual = 0;
  double min_J = 1, max_J = 1;
  Index inverted_cells = 0;                                                  // cells with J <= 0
  std::string warning;                                                       // StepReport::warning
  Energies energy;                                                           // [J]
  double load_potential() const { return energy.loads + energy.pressures; }  // [J]
  double potential_energy() const { return energy.elastic + energy.gravity + load_potential(); }  // [J]
  double total_energy() const { return energy.kinetic + potential_energy(); }                     // [J]
  VolumeMeasures total;                      // of all bodies together
  std::vector<VolumeMeasures> parts;         // bodies, and regions as "body.region" where a body has several
  std::array<Vec3, 2> momentum{};            // linear [kg m/s], angular about the origin [kg m^2/s]
  std::vector<std::array<Vec3, 2>> momenta;  // the same of each body
  double seconds = 0;                        // of this step's solve
  std::vector<Vec3> probes;                  // displacement of each probe [m]
  std::vector<CavityState> cavities;
  std::vector<Reaction> reactions;  // of each dirichlet support
  std::vector<Gauge> gauges;        // what else effects report, in the same order at every step
};

enum class RunStatus : std::uint8_t {
  converged,      // every step
  not_converged,  // up to the last record
  budget,         // stopped by the time allowed
  interrupted,
  bad_input,    // nothing was solved
  not_written,  // outputs could not be written: a full disk
  out_of_memory,
  failed,  // a fault of ours
};
const char* to_string(RunStatus status);

struct MetricValue {
  MetricDef def;
  double value = 0;
  bool reached = true;          // false: its time was not
  std::optional<double> error;  // relative to the reference; of a reference 0: absolute
  std::optional<bool> within;   // of the tolerance
};

// Where the error of an answer comes from, by body and cell of its mesh: World::error_origins().
struct AnswerOrigin {
  std::string name;  // of a metric, or "probe NAME"
  std::vector<std::vector<double>> cells;
  bool by_output = false;
  std::string note;
  std::string where;  // the same in words
};

struct RunOptions {
  std::string folder;            // where outputs go; empty: none are written
  int threads = 0;               // 0: all the machine has
  std::optional<double> budget;  // [s] of wall time, of this run alone where it resumes another
  // Goes on from the last checkpoint in `folder` with the bits of a run that was never stopped; from the
  // beginning where there is none. Refused where the scene is another.
  bool resume = false;
  bool origins = false;        // RunResult::origins are wanted; the run takes a factorization more
  std::function<bool()> stop;  // asked at every iteration; true interrupts
  // Processes that run it together (Host::ranks), each with these options. Rank 0 writes the outputs; a stop
  // or the end of the budget on any of them ends all, between steps.
  std::shared_ptr<const Ranks> ranks;
  std::function<void(const StepRecord&, int steps)> on_step;
  std::function<void(const std::string&)> log;  // warnings
};

struct RunResult {
  RunStatus status = RunStatus::bad_input;
  std::string reason;  // empty when converged; else one sentence
  std::string scene;
  int resumed_at = -1;        // step of the checkpoint that the run went on from; -1: none
  bool ended_before = false;  // nothing was left to resume: the run had converged
  int steps_asked = 0;
  std::vector<StepRecord> records;
  SolveCounters work;  // of all steps
  double wall_s = 0;
  StageSeconds stages;
  WorldSize size;
  Index elements = 0;
  int threads = 0;
  std::uint64_t state_hash = 0;
  std::vector<std::string> probes, cavities, supports;  // names, in the order of the records' lists
  std::vector<MetricValue> metrics;
  std::vector<std::string> warnings;
  bool wants_origins = false;
  std::vector<AnswerOrigin> origins;  // of a run that converged, where they were asked for
};

RunResult run_scene(const SceneDef& scene, const RunOptions& options = {});

std::vector<MetricValue> evaluate_metrics(const SceneDef& scene, const std::vector<StepRecord>& records);

// The text of summary.json.
std::string summary_json(const RunResult& result);
// As much of it as tells why there is no more.
std::string failure_json(const RunResult& result);

std::string version();
std::string build_description();    // build type and compiler
std::string machine_description();  // processor and its threads

}  // namespace isochor
