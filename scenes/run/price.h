// What errors of a scene would cost, before they are asked for.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scenes/run/error_search.h"
#include "scenes/run/run_cost.h"

namespace isochor {

struct PriceRow {
  double error = 0;                // relative
  std::optional<Setting> setting;  // none: no element gets there within the levels
  RunCost cost;                    // of the run with this setting
  double search_s = 0;             // of it and of the runs on the way to it that have not been made [s]
};

struct Price {
  std::string reason;         // empty, or why there is none
  std::vector<Trial> trials;  // runs of the scene that the prices follow from
  std::vector<PriceRow> rows;
  double seconds = 0;  // that the trials took
};

struct PriceOptions {
  std::vector<double> errors{0.1, 0.03, 0.01, 0.003};
  int most_levels = 4;
  // What a trial may take: better elements than that are priced from the others [s].
  double most_seconds = 60;
  RunOptions run;  // without outputs
  CostModel model;
  std::function<void(const Trial&)> on_trial;
};

// Runs the scene on its own mesh with the elements there are, or on its mesh and the next finer one where
// there is but one element, and extrapolates: errors by second order, cost by the model.
Price price_of(const SceneDef& scene, const PriceOptions& options);

}  // namespace isochor
