#include "scenes/json/parse.h"

#include <set>
#include <vector>

namespace isochor::scene_json {

namespace {

constexpr int kMostDepth = 64;

// Finds what the JSON library lets pass: keys given twice and nesting without end.
class StrictParse {
 public:
  bool operator()(int depth, Json::parse_event_t event, Json& parsed) {
    if (depth > kMostDepth) {
      fail("it is nested more than " + std::to_string(kMostDepth) + " deep");
      return false;
    }
    if (event == Json::parse_event_t::object_start) keys_.emplace_back();
    if (event == Json::parse_event_t::object_end && !keys_.empty()) keys_.pop_back();
    if (event == Json::parse_event_t::key && !keys_.empty()) {
      const auto& key = parsed.get_ref<const std::string&>();
      if (!keys_.back().insert(key).second)
        fail("key \"" + key + "\" is given twice in one object; keep one");
    }
    return true;
  }
  const std::string& error() const { return error_; }

 private:
  void fail(std::string message) {
    if (error_.empty()) error_ = std::move(message);
  }
  std::vector<std::set<std::string>> keys_;
  std::string error_;
};

}  // namespace

// "[json.exception...] parse error at line 3, column 5: syntax error..." without its bracket.
std::string plain(const char* what) {
  std::string text = what;
  if (const auto end = text.find("] "); !text.empty() && text[0] == '[' && end != std::string::npos) {
    text = text.substr(end + 2);
  }
  // Bytes of a broken file must not reach a terminal.
  for (char& c : text) {
    const auto u = static_cast<unsigned char>(c);
    if (u < 0x20 || u >= 0x7f) c = '?';
  }
  return text.size() > 300 ? text.substr(0, 300) + "..." : text;
}

Result<Json> parse_object(const std::string& text, const std::string& source, const std::string& what) {
  StrictParse strict;
  try {
    Json json = Json::parse(text, std::ref(strict));
    if (!strict.error().empty()) return Error{source + ": " + strict.error()};
    if (!json.is_object()) return Error{source + ": " + what + " is one object {...}"};
    return json;
  } catch (const std::exception& e) {
    return Error{source + ": " + (strict.error().empty() ? plain(e.what()) : strict.error())};
  }
}

}  // namespace isochor::scene_json
