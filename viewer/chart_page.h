// Pages of diagrams, bars and tables without a 3D view: one self-contained HTML file each.
#pragma once

#include <string>

#include "isochor/types.h"

namespace isochor {

// `json` is what viewer/web/src/charts.js draws: title, subtitle, footer, notes, run and sections. Refused
// when this library was built without node and npm.
Result<std::string> chart_page(const std::string& title, const std::string& json);

}  // namespace isochor
