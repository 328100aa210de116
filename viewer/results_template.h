// The pages without their data, put into the library by cmake/Viewer.cmake.
#pragma once

#include <string>

namespace isochor::page {

// Empty when node and npm were missing at build time.
const std::string& results_template();
const std::string& charts_template();
const std::string& live_template();

}  // namespace isochor::page
