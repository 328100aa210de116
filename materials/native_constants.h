// Helpers for materials that are given by constants of their own instead of E and nu.
#pragma once

#include <string_view>

#include "isochor/types.h"

namespace isochor {

Result<void> not_negative(std::string_view material, const char* key, double value);

}  // namespace isochor
