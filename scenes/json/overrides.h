// `--set path=value`, applied to a scene file before it is read strictly.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "isochor/types.h"

namespace isochor::scene_json {

// Goes down a path by key, by [index] or by the name of a list's entry, and makes what is not there yet:
// null. Messages call `json` by the name `whole`.
Result<nlohmann::ordered_json*> value_at(nlohmann::ordered_json& json, const std::string& path,
                                         const std::string& whole);

// Goes down by key, by [index] or by the name of a list's entry. The last key may be new; an index may be one
// past the end, which appends.
Result<void> apply_override(nlohmann::ordered_json& json, const std::string& assignment);

}  // namespace isochor::scene_json
