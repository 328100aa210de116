#include "live/recording.h"

#include <utility>

namespace isochor::live {

namespace {

// No run goes on from what was changed by hand.
SceneDef without_checkpoints(const SceneDef& scene) {
  SceneDef out = scene;
  out.outputs.checkpoint_steps = 0;
  out.outputs.checkpoint_seconds = 0;
  return out;
}

}  // namespace

Result<Recording> Recording::begin(const std::string& folder, const SceneDef& scene, const BuiltScene& built,
                                   const RunResult& description, StepRecord first) {
  auto outputs = RunOutputs::open(folder, without_checkpoints(scene));
  if (!outputs) return outputs.failure();
  RunResult result = description;
  result.records.clear();
  result.status = RunStatus::interrupted;
  result.reason = "the recording has not ended yet";
  result.warnings.emplace_back(
      "recorded live: amounts, constants and forces may have been changed by hand, and steps.csv and pages "
      "do "
      "not say when");
  first.step = 0;
  result.records.push_back(std::move(first));
  Recording recording(folder, std::move(outputs).value(), std::move(result));
  const SceneDef kept = without_checkpoints(scene);
  if (auto r = recording.outputs_.record({kept, built, recording.result_}, false); !r) return r.failure();
  return recording;
}

Result<bool> Recording::add(const SceneDef& scene, const BuiltScene& built, StepRecord record) {
  record.step = static_cast<int>(result_.records.size());
  result_.wall_s += record.seconds;
  result_.work += record.work;
  result_.steps_asked = record.step;
  result_.state_hash = built.world.state_hash();
  result_.size = built.world.size();
  result_.records.push_back(std::move(record));
  const SceneDef kept = without_checkpoints(scene);
  if (auto r = outputs_.record({kept, built, result_}, false); !r) return r.failure();
  return steps() < most_steps;
}

Result<void> Recording::end(const SceneDef& scene, const BuiltScene& built) {
  result_.status = RunStatus::converged;
  result_.reason.clear();
  result_.steps_asked = static_cast<int>(steps());
  result_.metrics = evaluate_metrics(scene, result_.records);
  const SceneDef kept = without_checkpoints(scene);
  const RunView view{kept, built, result_};
  if (auto r = outputs_.record(view, true); !r) return r;
  return outputs_.finish(view);
}

}  // namespace isochor::live
