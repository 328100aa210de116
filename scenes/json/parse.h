// Text to JSON, strictly.
#pragma once

#include <string>

#include "isochor/types.h"
#include "scenes/json/text.h"

namespace isochor::scene_json {

// One object; keys given twice, nesting without end and numbers too large are refused. Messages start with
// `source`; `what` is it that should be an object.
Result<Json> parse_object(const std::string& text, const std::string& source,
                          const std::string& what = "a scene file");

// What an exception of the JSON library says, fit for a message.
std::string plain(const char* what);

}  // namespace isochor::scene_json
