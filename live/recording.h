// What a live world leaves in a folder: the outputs of `isochor run`, from where the recording begins.
#pragma once

#include <optional>
#include <string>

#include "scenes/run/outputs.h"

namespace isochor::live {

class Recording {
 public:
  static constexpr std::size_t most_steps = 100000;

  // Opens the folder, and writes the state as step 0.
  static Result<Recording> begin(const std::string& folder, const SceneDef& scene, const BuiltScene& built,
                                 const RunResult& description, StepRecord first);
  // False: the recording is full.
  Result<bool> add(const SceneDef& scene, const BuiltScene& built, StepRecord record);
  // Tables, summary and page are whole then. The last state is in them as a frame.
  Result<void> end(const SceneDef& scene, const BuiltScene& built);

  std::size_t steps() const { return result_.records.size() - 1; }
  const std::string& folder() const { return folder_; }

 private:
  Recording(std::string folder, RunOutputs outputs, RunResult result)
      : folder_(std::move(folder)), outputs_(std::move(outputs)), result_(std::move(result)) {}
  std::string folder_;
  RunOutputs outputs_;
  RunResult result_;
};

}  // namespace isochor::live
