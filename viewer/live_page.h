// The page of scenes that run: it asks the server that it comes from for everything else.
#pragma once

#include <string>

namespace isochor {

// Empty where node and npm were missing at build time.
std::string live_page();

}  // namespace isochor
