// What a design found, as text, JSON, tables and a page.
#pragma once

#include "studies/design/design.h"
#include "studies/page.h"

namespace isochor::design {

// "reached", "nearest" (no choice within bounds comes closer, to first order) or "not converged".
const char* word(const Design& design);
std::string design_json(const Design& design);
// history.csv: a row a step.
std::string history_csv(const Design& design);
// field.csv: a row a cell; factor, and the standard deviation of its logarithm.
std::string field_csv(const Design& design);
std::vector<std::string> summary_lines(const Design& design);
studies::Page design_page(const Design& design);

}  // namespace isochor::design
