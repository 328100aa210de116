// Rule: one spelling, the American one.
#include <algorithm>
#include <cctype>

#include "tree.h"

namespace {

struct British {
  const char* letters;
  bool begins = false, ends = false;  // a word
};
constexpr British kBritish[] = {{"neighbour"},
                                {"colour"},
                                {"behaviour"},
                                {"factoris"},
                                {"analysed", false, true},
                                {"analysing", false, true},
                                {"centre"},
                                {"organis"},
                                {"globalis"},
                                {"minimis"},
                                {"optimis"},
                                {"normalis"},
                                {"initialis"},
                                {"regularis"},
                                {"linearis"},
                                {"modelled"},
                                {"modelling"},
                                {"labell"},
                                {"millimetre"},
                                {"metre", true, true},
                                {"metres", true, true},
                                {"favour"},
                                {"licence", true},
                                {"discretis"},
                                {"grey", true, true}};

bool in_word(const std::string& text, std::size_t i) {
  return i < text.size() && (std::isalnum(static_cast<unsigned char>(text[i])) || text[i] == '_');
}

// Where the first one is; npos: nowhere. `text` in small letters.
std::size_t find_british(const std::string& text, const British& word) {
  const std::string letters = word.letters;
  for (std::size_t i = text.find(letters); i != std::string::npos; i = text.find(letters, i + 1)) {
    const bool inside =
        (word.begins && i > 0 && in_word(text, i - 1)) || (word.ends && in_word(text, i + letters.size()));
    if (!inside) return i;
  }
  return std::string::npos;
}

}  // namespace

TEST_CASE("what is British is found") {
  const auto found = [](const char* text) {
    return std::any_of(std::begin(kBritish), std::end(kBritish),
                       [&](const British& word) { return find_british(text, word) != std::string::npos; });
  };
  for (const char* text : {"a neighbour", "analysed", "of grey steel", "two metres", "licences"})
    CHECK(found(text));
  for (const char* text : {"a neighbor", "analysis", "greyhound", "parameters", "geometre_"})
    CHECK_FALSE(found(text));
}

TEST_CASE("code and pages are spelled the American way") {
  int seen = 0;
  for (const auto& file : tree::files()) {
    const std::string name = tree::name_of(file);
    const bool text = tree::is_code(file) || file.extension() == ".md" || file.extension() == ".cmake" ||
                      file.filename() == "CMakeLists.txt";
    if (!text || name.starts_with("tests/data") || name == "tests/rules/spelling.cpp") continue;
    ++seen;
    std::string all = tree::text_of(file);
    std::transform(all.begin(), all.end(), all.begin(), [](unsigned char c) { return std::tolower(c); });
    for (const British& word : kBritish) {
      const std::size_t i = find_british(all, word);
      if (i != std::string::npos)
        FAIL_CHECK(name << ": " << all.substr(i - std::min<std::size_t>(i, 40), 60));
    }
  }
  CHECK(seen > 400);
}
