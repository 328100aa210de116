// The source tree as tests about it read it: files, lines, pages and their blocks.
#pragma once

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "catch.h"

namespace tree {

namespace fs = std::filesystem;

inline const fs::path root = ISOCHOR_SOURCE;

inline std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  REQUIRE(in.good());
  std::stringstream all;
  all << in.rdbuf();
  return all.str();
}

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::stringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// Files of a folder and all below it, sorted, without what is built or fetched.
inline std::vector<fs::path> files(const fs::path& folder = root) {
  std::vector<fs::path> found;
  for (auto it = fs::recursive_directory_iterator(folder); it != fs::recursive_directory_iterator(); ++it) {
    const std::string name = it->path().filename().string();
    if (it->is_directory() &&
        (name.starts_with("build") || name == "out" || name == "node_modules" || name == ".git")) {
      it.disable_recursion_pending();
    } else if (it->is_regular_file()) {
      found.push_back(it->path());
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

inline bool is_code(const fs::path& file) {
  return file.extension() == ".h" || file.extension() == ".cpp";
}

// With / between folders, from the root.
inline std::string name_of(const fs::path& file) {
  return fs::relative(file, root).generic_string();
}

inline std::vector<fs::path> pages() {
  std::vector<fs::path> found;
  for (const fs::path& file : files()) {
    if (file.extension() == ".md") found.push_back(file);
  }
  return found;
}

}  // namespace tree
