// What a run says of its contacts when it ends.
#include <algorithm>

#include "catch.h"
#include "small_scene.h"

namespace isochor {

namespace {

// A block under a plate whose middle goes from 0.2 above it to a place, with what is set besides.
std::vector<std::string> said(const std::string& motion, const std::string& extra) {
  const std::string text = R"({
    "bodies": [{"name": "block", "element": "tet4", "mesh": {"box": {"divisions": [2, 2, 2]}},
                "materials": [{"young": 1000, "poisson": 0.3}]}],
    "analysis": {"type": "static", "steps": 3},
    "dirichlet": [{"name": "ground", "where": {"surfaces": "z0"}}],
    "contacts": [{"name": "press", "body": "block", "surfaces": "z1", "obstacle": {"shape": "box",
                  "size": [4, 4, 0.2], "position": [0.5, 0.5, 1.2], "keyframes": [{"t": 0, "position": [0.5, 0.5, 1.2]},
                  {"t": 1, "position": )" +
                           motion + "}]}" + extra + "}]}";
  auto scene = parse_scene(text, "press.json", ".", {});
  if (!scene) FAIL(scene.error());
  RunOptions options;
  options.threads = 1;
  const RunResult result = run_scene(scene.value(), options);
  INFO(result.reason);
  CHECK(result.status == RunStatus::converged);
  return result.warnings;
}

bool tells(const std::vector<std::string>& warnings, const std::string& what) {
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const std::string& w) { return w.find(what) != std::string::npos; });
}

}  // namespace

TEST_CASE("a contact that never touches is told at the end, one that touches is not") {
  for (const auto& [motion, extra] : {std::pair<std::string, std::string>{"[0.5, 0.5, 1.5]", ""},
                                      {"[9, 0.5, 1.2]", ""},
                                      {"[0.5, 0.5, 1.15]", ""}}) {
    INFO(motion);
    CHECK(tells(said(motion, extra), "\"press\" never touched"));
  }
  CHECK_FALSE(tells(said("[0.5, 0.5, 1.0]", ""), "never touched"));
}

TEST_CASE("a layer that gives way by much of a face is told, with the remedy") {
  CHECK(tells(said("[0.5, 0.5, 0.9]", ", \"compliance\": 1e-3"), "smaller compliance"));
  CHECK_FALSE(tells(said("[0.5, 0.5, 0.9]", ", \"compliance\": 1e-6"), "smaller compliance"));
  CHECK_FALSE(tells(said("[0.5, 0.5, 0.9]", ""), "smaller compliance"));
}

}  // namespace isochor
