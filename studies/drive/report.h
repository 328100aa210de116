// What a drive found, as CSV, as JSON and as a table.
#pragma once

#include "studies/drive/drive.h"

namespace isochor::drive {

// drive.csv: a row a target; time, amounts, positions, targets, distance, and how it ended.
std::string drive_csv(const Drive& drive);
// drive.json: the same with bounds.
std::string drive_json(const Drive& drive);
// amounts.csv of a horizon: a row a point of the curves; of step by step empty.
std::string amounts_csv(const Drive& drive);
std::vector<std::string> table_head(const Drive& drive);
std::vector<std::string> table_row(const Drive& drive, const Reached& step);
// "reached", "nearest" (no amounts within bounds and rates come closer, to first order) or "not converged".
const char* word(const Reached& step);

}  // namespace isochor::drive
