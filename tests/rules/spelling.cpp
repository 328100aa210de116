// Rule: one spelling, the American one.
#include <regex>

#include "tree.h"

TEST_CASE("code and pages are spelled the American way") {
  const std::regex british(
      "neighbour|colour|behaviour|factoris|analys(ed|ing)\\b|centre|organis|globalis|minimis|optimis|"
      "normalis|initialis"
      "|regularis|linearis|modell(ed|ing)|labell|millimetre|\\bmetres?\\b|favour|\\blicence|discretis|"
      "\\bgrey\\b",
      std::regex::icase);
  int seen = 0;
  for (const auto& file : tree::files()) {
    const std::string name = tree::name_of(file);
    const bool text = tree::is_code(file) || file.extension() == ".md" || file.extension() == ".cmake" ||
                      file.filename() == "CMakeLists.txt";
    if (!text || name.starts_with("tests/data") || name == "tests/rules/spelling.cpp") continue;
    ++seen;
    const std::string all = tree::text_of(file);
    std::smatch found;
    if (std::regex_search(all, found, british))
      FAIL_CHECK(name << ": "
                      << found.prefix().str().substr(
                             static_cast<std::size_t>(std::max<std::ptrdiff_t>(found.position() - 40, 0)))
                      << found.str());
  }
  CHECK(seen > 400);
}
