// Where probes of a scene are to be, and when.
#pragma once

#include <string>
#include <vector>

#include "scenes/scene.h"

namespace isochor::drive {

// A component of the position of a probe.
struct Goal {
  std::string name;       // of the column: "tip.x"
  std::size_t probe = 0;  // of SceneDef::probes
  int component = 0;
};

struct Targets {
  std::vector<Goal> goals;
  std::vector<double> time;                // of the scene [s], or load factor; ascending, above 0
  std::vector<std::vector<double>> value;  // [time][goal], positions [m]
};

// A CSV file with a column "time" and columns "PROBE.x", "PROBE.y", "PROBE.z"; components that have no column
// are free. Errors name file, line and remedy.
Result<Targets> read_targets(const std::string& path, const SceneDef& scene);
Result<Targets> parse_targets(const std::string& text, const std::string& source, const SceneDef& scene);

}  // namespace isochor::drive
