// What the answers of a scene are worth when there is no reference: the scene is run once more with something
// better, and the difference is an indicator of the error.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenes/run/run.h"

namespace isochor {

// How a scene is compared.
enum class Comparison : std::uint8_t {
  better_element,  // Tet4 with edge smoothing, edge-smoothed Tet4 with Tet10
  finer_boxes,     // every box of Tet10 or Hex8 cut into eight
  worse_element,   // Tet10 on a mesh file with edge-smoothed Tet4: whose error it shows, an upper limit
};

struct AccuracyEntry {
  std::string name, unit;  // of a metric, or "probe NAME"
  double value = 0, other = 0;
  double indicator = 0;  // of the error of `value`, in its unit
  std::optional<double> relative;
};

struct Accuracy {
  Comparison comparison = Comparison::better_element;
  std::string how;     // a sentence: what was compared with what
  std::string reason;  // empty, or why there is no indicator
  std::vector<AccuracyEntry> entries;
  double seconds = 0;  // of the comparison
};

// The scene that `scene` is compared with, and how; an error says why there is none.
struct ComparedScene {
  SceneDef scene;
  Comparison comparison;
  std::string how;
};
Result<ComparedScene> compared_scene(const SceneDef& scene);

// `result` is that of the scene. Options as for its run; nothing is written.
Accuracy estimate_accuracy(const SceneDef& scene, const RunResult& result, const RunOptions& options = {});

// summary.json with the indicators under "accuracy".
std::string summary_json(const RunResult& result, const Accuracy& accuracy);

}  // namespace isochor
