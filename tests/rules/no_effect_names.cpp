// Rule: no stepper, solver or pattern code names an effect.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>

#include "catch.h"

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> general_code() {
  const fs::path engine = fs::path(ISOCHOR_SOURCE) / "engine";
  std::vector<fs::path> files;
  for (const char* name : {"solve/newton/newton", "system/system", "system/assembly", "base/parallel"}) {
    for (const char* ending : {".h", ".cpp"}) files.push_back(engine / (std::string(name) + ending));
  }
  files.push_back(engine / "step/time_scheme.h");
  files.push_back(engine / "solvers/linear_solver.h");
  files.push_back(engine / "system/pool.h");
  for (const auto& entry : fs::recursive_directory_iterator(engine / "solvers")) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  for (const auto& entry : fs::directory_iterator(fs::path(ISOCHOR_SOURCE) / "integrators")) {
    files.push_back(entry.path());
  }
  return files;
}

// Comments may give examples; code may not know any.
std::string without_comment(const std::string& line) {
  return line.substr(0, line.find("//"));
}

}  // namespace

TEST_CASE("the stepper, the pattern and the solvers name no effect") {
  const std::regex effect(
      "pressure|contact|dirichlet|zone|cavity|chamber|epidermis|cable|muscle|volume|traction|gravity",
      std::regex::icase);
  const auto files = general_code();
  CHECK(files.size() > 10);
  for (const fs::path& file : files) {
    std::ifstream in(file);
    INFO(file.string());
    REQUIRE(in.good());
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
      INFO("line " << number << ": " << line);
      CHECK_FALSE(std::regex_search(without_comment(line), effect));
    }
  }
}

TEST_CASE("the engine includes no effect, material or scheme") {
  const std::regex include("#include *\"(constraints|materials|integrators|scenes|apps|viewer)/");
  int seen = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(ISOCHOR_SOURCE) / "engine")) {
    if (!entry.is_regular_file()) continue;
    ++seen;
    std::ifstream in(entry.path());
    std::string line;
    while (std::getline(in, line)) {
      INFO(entry.path().string() << ": " << line);
      CHECK_FALSE(std::regex_search(line, include));
    }
  }
  CHECK(seen > 30);
}
