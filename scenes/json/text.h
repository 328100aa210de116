// JSON as text that people read.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace isochor::scene_json {

using Json = nlohmann::ordered_json;

// Whole numbers without a decimal point.
Json plain_number(double value);

// On one line.
std::string inline_text(const Json& json);
// Short values on one line, so that vectors and curves read as such.
std::string text_of(const Json& json);

}  // namespace isochor::scene_json
