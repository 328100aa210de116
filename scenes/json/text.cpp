#include "scenes/json/text.h"

#include <cmath>

namespace isochor::scene_json {

namespace {

std::string pretty(const Json& json, std::size_t indent) {
  constexpr std::size_t kWidth = 100;
  const std::string line = inline_text(json);
  if (!json.is_structured() || json.empty() || (indent > 0 && indent + line.size() < kWidth)) return line;
  const std::string margin(indent + 2, ' ');
  std::string text;
  for (const auto& [key, value] : json.items()) {
    text += (text.empty() ? "" : ",\n") + margin;
    const std::string lead = json.is_object() ? Json(key).dump() + ": " : "";
    text += lead + pretty(value, indent + 2);
  }
  const std::string end = "\n" + std::string(indent, ' ');
  return json.is_object() ? "{\n" + text + end + "}" : "[\n" + text + end + "]";
}

}  // namespace

Json plain_number(double value) {
  const bool whole = value == std::floor(value) && std::abs(value) < 1e15;
  return whole ? Json(static_cast<std::int64_t>(value)) : Json(value);
}

std::string inline_text(const Json& json) {
  if (!json.is_structured()) return json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string text;
  for (const auto& [key, value] : json.items()) {
    text += text.empty() ? "" : ", ";
    if (json.is_object()) text += Json(key).dump() + ": ";
    text += inline_text(value);
  }
  return json.is_object() ? "{" + text + "}" : "[" + text + "]";
}

std::string text_of(const Json& json) {
  return pretty(json, 0);
}

}  // namespace isochor::scene_json
