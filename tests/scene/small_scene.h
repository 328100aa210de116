// A scene that runs in a blink: a soft block held at one end, pulled at the other.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "scenes/run/run.h"
#include "scenes/scene_file.h"
#include "support/files.h"

namespace isochor::test {

using files::slurp;

inline const char* small_text() {
  return R"({
    "name": "small",
    "bodies": [{"name": "block",
                "mesh": {"box": {"upper": [2, 1, 1], "divisions": [2, 1, 1]}},
                "materials": [{"young": 1000, "poisson": 0.5}]}],
    "analysis": {"steps": 3},
    "dirichlet": [{"name": "wall", "where": {"surfaces": "x0"}}],
    "tractions": [{"name": "pull", "surface": "x1", "traction": [100, 0, 0]}],
    "probes": [{"name": "tip", "point": [2, 0.5, 0.5]}],
    "metrics": [{"name": "pulled", "of": "tip", "component": "x"}]
  })";
}

inline SceneDef small_scene(const Overrides& overrides = {}) {
  auto scene = parse_scene(small_text(), "small.json", ".", overrides);
  return scene ? scene.value() : SceneDef{};
}

// A folder of its own, gone with the test.
class Scratch {
 public:
  explicit Scratch(const std::string& name)
      : path_(std::filesystem::temp_directory_path() /
              ("isochor_" + name + "_" + std::to_string(::getpid()))) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~Scratch() {
    std::error_code code;
    std::filesystem::remove_all(path_, code);
  }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  std::string string() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

}  // namespace isochor::test
