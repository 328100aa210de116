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
  finer_mesh,      // every cell of Tet10 or Hex8 cut into eight
  worse_element,   // Tet10 on a mesh of Tet4 with edge-smoothed Tet4: whose error it shows, an upper limit
};

// A number that a run answers with and that has an error of discretization.
struct Answer {
  std::string name, unit;  // of a metric, or "probe NAME"
  Vec3 value{};            // of a metric in x
  double size = 0;         // what its error is relative to; 0: nothing
  bool vector = false;
  // As tables show it: a metric with its sign, a probe by how far it went.
  double shown() const;
};
// Metrics that were reached, without counts, residuals and extremes over cells, then the probes at the end.
std::vector<Answer> answers_of(const RunResult& result);
// Whether a scene asks for any.
bool has_answers(const SceneDef& scene);

struct AccuracyEntry {
  std::string name, unit;  // of a metric, or "probe NAME"
  double value = 0, other = 0;
  double indicator = 0;  // of the error of `value`, in its unit
  std::optional<double> relative;
  std::string where = {};  // on the mesh it comes from, of runs that were asked for origins
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
