// The cost model of this machine, measured once and kept.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "scenes/run/run_cost.h"

namespace isochor {

// Runs cubes of every element on two meshes each: some seconds. Empty where `stop` said so or a run failed.
std::optional<CostModel> measure_cost_model(int threads, const std::function<bool()>& stop = {});

// $XDG_CACHE_HOME/isochor/cost_model.json, or ~/.cache in place of the first; empty: there is no such place.
std::string cost_model_file();

// As text, and back; nothing where it is damaged, or of another machine, build or number of threads.
std::string to_text(const CostModel& model, int threads);
std::optional<CostModel> cost_model_from_text(const std::string& text, int threads);

// From the file, or measured and put there. `log` is told what is measured and what could not be kept.
CostModel machine_cost_model(int threads, const std::function<bool()>& stop,
                             const std::function<void(const std::string&)>& log);

}  // namespace isochor
