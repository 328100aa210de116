// The subcommands of `isochor`. Each returns the exit code.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scenes/explain.h"
#include "scenes/run/error_search.h"
#include "scenes/run/run.h"

namespace isochor::app {

enum Exit : int {
  success = 0,
  internal = 1,
  bad_input = 2,
  not_converged = 3,
  out_of_budget = 4,
  not_written = 5,
  out_of_memory = 6,
  no_port = 7,        // live: the address cannot be listened on
  unavailable = 8,    // live: not in this build
  interrupted = 130,  // as shells report SIGINT
};

// A scene of the library by its name, or a scene file.
Result<SceneDef> find_scene_named(const std::string& name, const std::vector<std::string>& overrides);

struct RunArguments {
  std::string scene = "finger";
  std::vector<std::string> overrides;
  std::string folder;  // empty: out/NAME
  int threads = 0;
  std::optional<double> budget;
  bool quiet = false, json = false, explain = false, accuracy = false;
  bool resume = false, price = false;
  std::optional<std::string> error;  // "1%" or "0.01": search for it
  std::optional<double> checkpoint;  // [s], in place of outputs.checkpoint_seconds
  std::string petsc;                 // options of PETSc
};

// Where memory ran out: says so, and ends the process at once. Threads of libraries that found no memory
// would be waited for without end.
[[noreturn]] void end_without_memory();

// Tables of `run --explain`, after the run.
void print_explanation(const Explanation& explanation, const RunResult& result);

// Metrics, the state at the end and where the outputs are.
void print_summary(const RunResult& result, const std::string& folder);
void print_explanation_of(const SceneDef& scene, const RunResult& result);

// Of a run, by how it ended.
int exit_code(RunStatus status);

// run --error and run --price.
void print_trial(const Trial& trial);
int run_to_error(const RunArguments& arguments, const SceneDef& scene);
int price(const RunArguments& arguments, const SceneDef& scene);

struct StudyArguments {
  std::string study;
  std::string folder;  // empty: out/study/NAME, with _quick
  std::string only;    // text in the names of the cells to measure; empty: all
  bool quick = false, fresh = false, list = false, quiet = false;
  bool check = false, update = false;
  int threads = 0;
  // Of chaos.
  std::string seeds = "1-100";
  double limit = 120;  // [s] a seed
  int jobs = 1;
  bool keep = false, untimed = false;
};

struct FitArguments {
  std::vector<std::string> curves;  // files, with ":mode" behind
  // Constants of scenes in place of laws: SCENE:DATA or SCENE:DATA:WEIGHT, and PATH=LEAST:MOST.
  std::vector<std::string> scenes, constants, overrides;
  int threads = 0;
  std::vector<std::string> laws;  // empty: all
  std::string folder;             // empty: out/fit/NAME
  std::string strain, stress, stress_unit;
  std::optional<double> lowest, highest;  // engineering strain
  bool relative = false, json = false, quiet = false;
};

struct PronyArguments {
  std::string file, folder;  // folder empty: out/fit/NAME
  std::string time, value;   // columns
  int terms = 3;
  double ramp = 0;  // [s]
  bool json = false, quiet = false;
};

struct ViewArguments {
  std::string folder;
  bool remake = false;         // from the frames, even where there is a page
  bool quiet_browser = false;  // only say where it is
};

struct LiveArguments {
  std::string scene = "finger";
  std::vector<std::string> overrides;
  std::string host = "127.0.0.1";
  std::string folder;     // of recordings; empty: out/live_NAME
  std::string export_to;  // a page in the place of a server; empty: none
  int port = 0, threads = 0;
  double step_limit = 60;  // [s]
  bool dynamic = false, readonly = false, paused = false, record = false, quiet_browser = false;
};

// False where no browser could be started.
bool open_in_browser(const std::string& address);

// Says what is wrong with the arguments; bad_input.
int refuse(const std::string& what);

// `ranks`: processes that run it together; null: this one alone.
int run(const RunArguments& arguments, std::shared_ptr<const Ranks> ranks = {});
#ifdef ISOCHOR_HAVE_PETSC
// As one of the processes that mpirun has started.
int run_on_ranks(RunArguments arguments);
#endif
int live(const LiveArguments& arguments);
// A scene as one page; dynamic already where that was asked for.
int export_live(const LiveArguments& arguments, const SceneDef& scene);
int view(const ViewArguments& arguments);
int study(const StudyArguments& arguments);
int fit_laws(const FitArguments& arguments);
int fit_constants(const FitArguments& arguments);
int fit_prony(const PronyArguments& arguments);

struct DriveArguments {
  std::string scene, targets, folder;           // folder empty: out/drive/NAME
  std::vector<std::string> amounts, overrides;  // amounts: NAME=LEAST:MOST:RATE
  double tolerance = 1e-6;                      // [m]
  bool horizon = false;                         // all amounts at once
  int every = 1;
  std::optional<double> smooth;
  int threads = 0;
  bool json = false, quiet = false;
};
int drive_scene(const DriveArguments& arguments);

struct DesignArguments {
  std::string scene, targets, folder;  // folder empty: out/design/NAME
  std::vector<std::string> overrides;
  std::vector<std::string> moves, hold;  // SURFACE=LEAST:MOST; surfaces
  std::string stiffness;                 // a body; empty: none
  double length = 0, spread = 0.5;       // of the stiffness field [m], of its logarithm
  double least_factor = 0.01, most_factor = 100;
  std::optional<double> noise, least_volume, most_volume;  // over the largest change; [m^3]
  double quality = 0.2;
  int iterations = 60, threads = 0;
  bool json = false, quiet = false;
};
int design_scene(const DesignArguments& arguments);
// The study of random scenes; `stop` is asked now and then.
int chaos(const StudyArguments& arguments, const std::function<bool()>& stop);
int show(const std::string& scene, const std::vector<std::string>& overrides);
int list(bool json);
// Every key of a scene file: for a terminal, as JSON Schema, or as the tables of docs/scenes.md.
enum class KeysAs { lines, schema, tables };
int keys(KeysAs as);
int check(const std::vector<std::string>& meshes, double scale, bool triangles, bool json);
int version(bool json);

}  // namespace isochor::app
