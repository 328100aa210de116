#include "live/command.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "engine/base/text.h"

namespace isochor::live {

namespace {

using Json = nlohmann::json;

struct Known {
  const char* word;
  Action action;
  std::vector<const char*> keys;
};

const std::vector<Known>& all_known() {
  static const std::vector<Known> known = {{"take", Action::take, {}},
                                           {"play", Action::play, {}},
                                           {"pause", Action::pause, {}},
                                           {"step", Action::step, {}},
                                           {"reset", Action::reset, {}},
                                           {"speed", Action::speed, {"value"}},
                                           {"set", Action::set, {"control", "value"}},
                                           {"pull", Action::pull, {"triangle", "weights"}},
                                           {"pin", Action::pin, {"triangle", "weights"}},
                                           {"push", Action::push, {"triangle", "weights"}},
                                           {"move", Action::move, {"handle", "to"}},
                                           {"release", Action::release, {"handle"}},
                                           {"record", Action::record, {}},
                                           {"stop_recording", Action::stop_recording, {}}};
  return known;
}

constexpr double kLargest = 1e12;  // of any number: beyond is no quantity of a scene

Result<double> finite(const Json& value, const std::string& key) {
  if (!value.is_number()) return Error{key + " must be a number"};
  const double v = value.get<double>();
  if (!std::isfinite(v) || std::abs(v) > kLargest)
    return Error{key + " = " + number(v) + "; it must be finite and no larger than 1e12"};
  return v;
}

Result<int> whole(const Json& value, const std::string& key) {
  if (!value.is_number_integer()) return Error{key + " must be a whole number"};
  const double v = value.get<double>();
  if (!(v >= 0 && v <= 1e9)) return Error{key + " = " + number(v) + "; it must be from 0 to 1e9"};
  return static_cast<int>(v);
}

Result<std::array<double, 3>> triple(const Json& value, const std::string& key) {
  if (!value.is_array() || value.size() != 3) return Error{key + " must be a list of three numbers"};
  std::array<double, 3> out{};
  for (std::size_t k = 0; k < 3; ++k) {
    auto v = finite(value[k], key + "[" + std::to_string(k) + "]");
    if (!v) return v.failure();
    out[k] = v.value();
  }
  return out;
}

Result<void> read_weights(const Json& value, Command& command) {
  auto w = triple(value, "weights");
  if (!w) return w.failure();
  command.weights = w.value();
  double sum = 0;
  bool within = true;
  for (const double v : command.weights) {
    sum += v;
    within = within && v >= -1e-3;
  }
  if (!within || std::abs(sum - 1) > 1e-3)
    return Error{"weights must be those of a point of the triangle: none negative, their sum 1"};
  return {};
}

Result<void> read_key(const Json& json, const std::string& key, Command& command) {
  const Json& value = json.at(key);
  if (key == "value") {
    auto v = finite(value, key);
    if (!v) return v.failure();
    command.value = v.value();
  } else if (key == "to") {
    auto v = triple(value, key);
    if (!v) return v.failure();
    command.to = {v.value()[0], v.value()[1], v.value()[2]};
  } else if (key == "weights") {
    return read_weights(value, command);
  } else {
    auto v = whole(value, key);
    if (!v) return v.failure();
    (key == "control" ? command.control : key == "handle" ? command.handle : command.triangle) = v.value();
  }
  return {};
}

}  // namespace

Result<Command> parse_command(std::string_view text) {
  if (text.size() > largest_message) {
    return Error{"the message has " + std::to_string(text.size()) + " bytes; at most " +
                 std::to_string(largest_message) + " are read"};
  }
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object()) return Error{"the message must be a JSON object"};
  if (!json.contains("do") || !json["do"].is_string())
    return Error{"the message must say what to do, as in {\"do\": \"play\"}"};
  const std::string word = json["do"].get<std::string>();
  std::string words;
  for (const Known& known : all_known()) {
    words += (words.empty() ? "" : ", ") + std::string(known.word);
    if (word != known.word) continue;
    Command command;
    command.action = known.action;
    for (const char* key : known.keys) {
      if (!json.contains(key)) return Error{"\"" + word + "\" needs the key " + key};
      if (auto r = read_key(json, key, command); !r) return r.failure();
    }
    if (json.size() != known.keys.size() + 1) return Error{"\"" + word + "\" has keys that it does not know"};
    return command;
  }
  return Error{"the message asks for what there is not; there are " + words};
}

bool replaces(const Command& later, const Command& earlier) {
  if (later.action != earlier.action) return false;
  if (later.action == Action::set) return later.control == earlier.control;
  return later.action == Action::move && later.handle == earlier.handle;
}

}  // namespace isochor::live
