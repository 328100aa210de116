// Measured cells as JSON and CSV.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "studies/study.h"

namespace isochor::studies {

struct StoreHead {
  std::string study, title;
  bool quick = false, complete = false;
  int threads = 0;
};

std::string results_json(const StoreHead& head, std::span<const Measured> cells);
// Cells of a results.json; empty when there is none or it is not one.
std::vector<Measured> read_results(const std::string& path);
std::string results_csv(std::span<const Measured> cells);

}  // namespace isochor::studies
