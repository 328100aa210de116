// Where probes of a scene are to be, what supports are to feel and chambers to hold, and when.
#pragma once

#include <string>
#include <vector>

#include "studies/inverse/data.h"

namespace isochor::drive {

struct Targets {
  std::vector<inverse::Quantity> goals;
  std::vector<double> time;                // of the scene [s], or load factor; ascending, above 0
  std::vector<std::vector<double>> value;  // [time][goal], in SI units
};

// A CSV file with a column "time" and columns of quantities (studies/inverse/data.h): "PROBE.x",
// "SUPPORT.force.z", "CAVITY.volume"; components that have no column are free. Errors name file, line and
// remedy.
Result<Targets> read_targets(const std::string& path, const SceneDef& scene);
Result<Targets> parse_targets(const std::string& text, const std::string& source, const SceneDef& scene);

}  // namespace isochor::drive
