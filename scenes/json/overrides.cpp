#include "scenes/json/overrides.h"

#include <vector>

#include "scenes/json/reader.h"

namespace isochor::scene_json {

namespace {

struct Segment {
  std::string key;
  bool is_index = false;
  std::size_t index = 0;
};

// bodies[0].materials[0].poisson -> bodies, 0, materials, 0, poisson
Result<std::vector<Segment>> split(const std::string& path) {
  std::vector<Segment> segments;
  std::size_t i = 0;
  while (i < path.size()) {
    if (path[i] == '[') {
      const auto end = path.find(']', i);
      const std::string digits = end == std::string::npos ? "" : path.substr(i + 1, end - i - 1);
      if (digits.empty() || digits.size() > 9 ||
          digits.find_first_not_of("0123456789") != std::string::npos) {
        return Error{"expected [number] at \"" + path.substr(i) + "\""};
      }
      segments.push_back({digits, true, std::stoul(digits)});
      i = end + 1;
    } else {
      const auto end = std::min(path.find_first_of(".[", i), path.size());
      if (end == i) return Error{"a key is empty"};
      segments.push_back({path.substr(i, end - i)});
      i = end;
    }
    if (i < path.size() && path[i] == '.') {
      if (++i == path.size()) return Error{"it ends with a dot"};
    }
  }
  if (segments.empty()) return Error{"the path is empty"};
  return segments;
}

Result<Json*> enter_list(Json& list, const Segment& s, const std::string& so_far) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const bool named = list[i].is_object() && list[i].contains("name") && list[i]["name"].is_string();
    names.push_back(named ? list[i]["name"].get<std::string>() : "");
  }
  if (!s.is_index) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i] == s.key) return &list[i];
    }
    std::string known;
    for (const auto& n : names) known += (known.empty() ? "" : ", ") + n;
    return Error{so_far + " has no entry named \"" + s.key + "\"" + suggestion(s.key, names) +
                 "; its entries: " + known};
  }
  if (s.index > list.size()) {
    return Error{so_far + " has " + std::to_string(list.size()) + " entries, there is no [" + s.key + "]"};
  }
  if (s.index == list.size()) list.push_back(Json());
  return &list[s.index];
}

Result<Json*> enter(Json& at, const Segment& s, const std::string& so_far) {
  // What is not there yet takes the form that the path asks for.
  if (at.is_null()) at = s.is_index ? Json::array() : Json::object();
  if (at.is_array()) return enter_list(at, s, so_far);
  if (at.is_object() && !s.is_index) return &at[s.key];
  return Error{so_far + " is " + shown(at) + ", it has no " +
               (s.is_index ? "[" + s.key + "]" : "\"" + s.key + "\"")};
}

}  // namespace

Result<Json*> value_at(Json& json, const std::string& path, const std::string& whole) {
  auto segments = split(path);
  if (!segments) return segments.failure();
  Json* at = &json;
  std::string so_far;
  for (const Segment& s : segments.value()) {
    auto next = enter(*at, s, so_far.empty() ? whole : so_far);
    if (!next) return next.failure();
    at = next.value();
    so_far += s.is_index ? "[" + s.key + "]" : (so_far.empty() ? "" : ".") + s.key;
  }
  return at;
}

Result<void> apply_override(Json& json, const std::string& assignment) {
  const auto equals = assignment.find('=');
  const std::string who = "--set " + assignment + ": ";
  if (equals == std::string::npos || equals == 0) {
    return Error{who + "expected path=value, as in cavities[0].amount=8000"};
  }
  const std::string path = assignment.substr(0, equals), text = assignment.substr(equals + 1);
  const auto at = value_at(json, path, "the scene");
  if (!at) return Error{who + at.error()};
  Json value = Json::parse(text, nullptr, false);
  *at.value() = value.is_discarded() ? Json(text) : std::move(value);
  return {};
}

}  // namespace isochor::scene_json
