// The world of a scene that people play with: what commands do to it, its steps, and what is shown of it.
// For one thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "live/command.h"
#include "live/dials.h"
#include "live/hand.h"
#include "live/recording.h"
#include "scenes/run/page_shape.h"
#include "scenes/run/step_recorder.h"

namespace isochor::live {

struct SimulationOptions {
  int threads = 0;                    // 0: all the machine has
  std::string folder;                 // of recordings; the second goes into FOLDER_2
  double step_limit = 60;             // [s] that a step may take
  std::function<bool()> interrupted;  // asked while a step works, from any thread; may be empty
};

// A number that is drawn over time.
struct Measure {
  std::string group, name, unit;
};

// What is shown of a world at one time.
struct Picture {
  PageFrame frame;  // with fields of bodies, or with positions alone
  int step = 0;
  double time = 0;                      // [s], or load factor
  std::vector<double> dials, measures;  // in the order of the lists
  std::vector<HandleState> handles;
  std::string message;  // why the last step failed, or what was refused; empty: nothing to say
  bool failed = false;  // the last step
  int recorded = -1;    // steps of a recording; -1: none
  std::string recorded_in;
  std::uint64_t hash = 0;  // of the state
};

enum class StepEnd : std::uint8_t { done, failed, interrupted };

class Simulation {
 public:
  static Result<std::unique_ptr<Simulation>> make(SceneDef scene, SimulationOptions options);

  // Of what changes the world; take, play, pause, speed and step are not its matter. What is refused is in
  // the next picture as well.
  Result<void> apply(const Command& command);
  StepEnd advance();
  // Statics at the end of the loading, where nothing has changed since: another step would be the same state.
  bool settled() const;
  // In good order: ends a recording.
  Result<void> close();
  void say(const std::string& message) { message_ = message; }

  Picture picture(bool fields) const;
  BodyFields fields_now(std::size_t body) const { return built_->world.fields(built_->bodies[body]); }
  const SceneDef& scene() const { return scene_; }
  const PageScene& shape() const { return shape_->scene(); }
  const std::vector<Dial>& dials() const { return dials_->list(); }
  const std::vector<Measure>& measures() const { return measures_; }
  // Fields with one value a triangle, which do not change.
  const std::vector<std::vector<double>>& maps() const { return maps_; }
  // What building the scene has noticed.
  std::vector<std::string> notes() const;
  bool records() const { return !options_.folder.empty(); }  // there is a folder for recordings
  bool has_fibers() const { return shape_->has_fibers(); }
  Index elements() const { return shown_.elements; }
  double step_length() const { return plan_.h; }
  bool dynamic() const { return scene_.analysis.type == AnalysisType::dynamics; }
  double time() const { return built_->world.time(); }
  double seconds_of_step() const { return seconds_; }  // the last

 private:
  Simulation(SceneDef scene, SimulationOptions options);
  Result<void> start();
  Result<void> begin_again();
  Result<Hit> hit(const Command& command) const;
  Result<void> record();
  Result<void> end_recording();
  StepRecord look() const;
  void list_measures();
  Result<void> keep_schedule();
  StepEnd told(const StepReport& report, double before, bool too_long);

  SceneDef scene_;
  SimulationOptions options_;
  StepPlan plan_;
  std::optional<BuiltScene> built_;
  std::optional<World> beginning_;  // of which every beginning is a copy
  std::vector<ScheduledEffect> scheduled_at_first_;
  std::optional<PageShape> shape_;
  std::optional<Poses> poses_;
  std::unique_ptr<Dials> dials_;
  Hand hand_;
  std::unique_ptr<StepRecorder> recorder_;
  std::optional<Recording> recording_;
  mutable RunResult shown_;  // with the record of the state now
  StepReport report_;
  std::vector<Measure> measures_;
  std::vector<std::vector<double>> maps_;
  std::size_t gauges_ = 0;  // of the scene itself
  int step_ = 0, recordings_ = 0;
  double seconds_ = 0;
  bool changed_ = true, failed_ = false;
  std::string message_;
};

}  // namespace isochor::live
