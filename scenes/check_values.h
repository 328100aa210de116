// What checks of scenes share: places and numbers in messages, names, curves.
#pragma once

#include <string>

#include "isochor/curves.h"
#include "isochor/types.h"

namespace isochor {

// "cavities[2]".
std::string place(const std::string& list, std::size_t i);

// Names become file names, CSV columns and keys of the summary.
Result<void> check_name(const std::string& where, const std::string& name);

// Points there are, finite, by ascending time.
Result<void> check_curve(const std::string& where, const Curve& curve);

}  // namespace isochor
