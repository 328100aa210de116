// Messages of viewers: what is understood, and that all else is refused with a sentence.
#include "live/command.h"

#include <random>

#include "catch.h"

using namespace isochor;
using namespace isochor::live;

TEST_CASE("every command is understood with exactly its keys") {
  const auto read = [](const char* text) {
    const auto c = parse_command(text);
    INFO(text);
    REQUIRE(c.ok());
    return c.value();
  };
  CHECK(read(R"({"do": "play"})").action == Action::play);
  CHECK(read(R"({"do": "pause"})").action == Action::pause);
  CHECK(read(R"({"do": "step"})").action == Action::step);
  CHECK(read(R"({"do": "reset"})").action == Action::reset);
  CHECK(read(R"({"do": "take"})").action == Action::take);
  CHECK(read(R"({"do": "record"})").action == Action::record);
  CHECK(read(R"({"do": "stop_recording"})").action == Action::stop_recording);
  CHECK(read(R"({"do": "speed", "value": 0.5})").value == 0.5);
  const Command set = read(R"({"do": "set", "control": 3, "value": -1.5e4})");
  CHECK(set.control == 3);
  CHECK(set.value == -1.5e4);
  for (const char* word : {"pull", "pin", "push"}) {
    const Command hold = read(
        (std::string(R"({"do": ")") + word + R"(", "triangle": 7, "weights": [0.5, 0.25, 0.25]})").c_str());
    CHECK(hold.triangle == 7);
    CHECK(hold.weights[1] == 0.25);
  }
  const Command move = read(R"({"do": "move", "handle": 2, "to": [1, 2, 3]})");
  CHECK(move.handle == 2);
  CHECK(move.to == Vec3{1, 2, 3});
  CHECK(read(R"({"do": "release", "handle": 2})").handle == 2);
}

TEST_CASE("what is no command is refused with a sentence") {
  const std::pair<std::string, const char*> cases[] = {
      {"", "must be a JSON object"},
      {"[]", "must be a JSON object"},
      {"{}", "must say what to do"},
      {R"({"do": 1})", "must say what to do"},
      {R"({"do": "explode"})", "there are take, play"},
      {R"({"do": "play", "x": 1})", "keys that it does not know"},
      {R"({"do": "set", "control": 1})", "needs the key value"},
      {R"({"do": "set", "control": -1, "value": 0})", "from 0"},
      {R"({"do": "set", "control": 1.5, "value": 0})", "whole number"},
      {R"({"do": "set", "control": 1, "value": "2"})", "must be a number"},
      {R"({"do": "set", "control": 1, "value": 1e300})", "no larger than 1e12"},
      {R"({"do": "set", "control": 1e400, "value": 1})", "JSON object"},
      {R"({"do": "move", "handle": 1, "to": [1, 2]})", "list of three numbers"},
      {R"({"do": "move", "handle": 1, "to": [1, 2, null]})", "to[2] must be a number"},
      {R"({"do": "pull", "triangle": 0, "weights": [2, -1, 0]})", "weights"},
      {R"({"do": "pull", "triangle": 0, "weights": [0.1, 0.1, 0.1]})", "their sum 1"},
      {std::string(largest_message + 1, ' '), "at most 2048"},
  };
  for (const auto& [text, says] : cases) {
    const auto c = parse_command(text);
    INFO(text);
    REQUIRE_FALSE(c.ok());
    CHECK(c.error().find(says) != std::string::npos);
    CHECK(c.error().find('\n') == std::string::npos);
  }
}

TEST_CASE("damaged messages are read or refused, never more") {
  std::mt19937 random(1);
  const std::string good[] = {R"({"do": "set", "control": 3, "value": -1.5e4})",
                              R"({"do": "pull", "triangle": 7, "weights": [0.5, 0.25, 0.25]})",
                              R"({"do": "move", "handle": 2, "to": [1, 2, 3]})"};
  int understood = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string text = good[random() % 3];
    for (auto k = 1 + random() % 3; k > 0; --k) text[random() % text.size()] = static_cast<char>(random());
    const auto c = parse_command(text);
    understood += c.ok();
    if (!c) CHECK(c.error().size() > 5);
  }
  CHECK(understood > 0);
  // Deep nesting must not cost a deep stack.
  CHECK_FALSE(parse_command(std::string(2000, '[')).ok());
}

TEST_CASE("a later value of one target replaces the earlier one") {
  Command a, b;
  a.action = b.action = Action::set;
  a.control = b.control = 1;
  CHECK(replaces(b, a));
  b.control = 2;
  CHECK_FALSE(replaces(b, a));
  a.action = b.action = Action::move;
  a.handle = b.handle = 4;
  CHECK(replaces(b, a));
  a.action = b.action = Action::step;
  CHECK_FALSE(replaces(b, a));
}
