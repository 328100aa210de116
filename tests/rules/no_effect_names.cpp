// Rule: no stepper, solver or pattern code names an effect. What is guarded are whole rooms; the words are
// those of the effects themselves: their functions, types and controls in include/isochor/effects, and their
// files.
#include <algorithm>
#include <map>
#include <regex>

#include "rules/tree.h"

namespace {

using tree::fs::path;

const std::vector<std::string> kGuarded{"engine/base",  "engine/math", "engine/solvers", "engine/system",
                                        "engine/solve", "engine/step", "integrators"};

// Words that effects share with the engine: each means something there without any effect.
const std::set<std::string>
    kGeneral{
        "body",    "box",        "control",   "coupled",    "coupling", "damping", "def",      "distance",
        "edge",    "edges",      "element",   "intrusion",  "effect",   "field",   "force",    "frame",
        "face",    "initial",    "lagged",    "length",     "limit",    "loads",   "memory",   "mesh",
        "moved",   "multiplier", "network",   "node",       "nodes",    "patch",   "plane",    "point",
        "pool",    "poses",      "ratio",     "report",     "resolve",  "ring",    "rows",     "segment",
        "shape",   "solid",      "space",     "stiffness",  "strain",   "support", "geometry", "turning",
        "surface", "threads",    "treatment", "tree",       "closed",   "law",     "amount",   "row",
        "linear",  "growth",     "current",   "constraint",  // of systems, of numbers, of memory
        "load",                                              // of states: what save() wrote
        "idle",                                              // of rows that no free coordinate enters
        "fields",                                            // of structs
        "volume",  // the engine's own functions of bodies (SolidPool), which rows of effects are over
        "impact",  "impacts"  // jumps of velocities, whatever makes them
    };

// Identifiers that hold a word of an effect and yet name none.
const std::set<std::string> kNamesNone{"sees_rigid_motion"};

// "SurfaceContactDef" and "surface_contact" are surface and contact.
std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words(1);
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    const bool upper = std::isupper(static_cast<unsigned char>(c));
    if (c == '_' || (upper && i > 0 && !std::isupper(static_cast<unsigned char>(name[i - 1]))))
      words.emplace_back();
    if (c != '_') words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return words;
}

// Comments may give examples, and sentences to a host may; code may not know any.
std::string code_of(const std::string& text) {
  static const std::regex comment("//[^\n]*"), sentence("\"[^\"\n]* [^\"\n]*\"");
  return std::regex_replace(std::regex_replace(text, sentence, "\"\""), comment, "");
}

std::set<std::string> effect_words() {
  std::set<std::string> words;
  const auto add = [&](const std::string& name) {
    for (const std::string& word : words_of(name)) words.insert(word);
  };
  static const std::regex name(R"(EffectPtr (\w+)\(|(?:struct|class) (\w+) \{|enum class (\w+))");
  static const std::regex kinds(R"(enum class \w+ : [\w:]+ \{([^}]*)\})"), word("\\w+");
  for (const path& file : tree::files(tree::root / "include" / "isochor" / "effects")) {
    const std::string text = code_of(tree::text_of(file));
    for (auto it = std::sregex_iterator(text.begin(), text.end(), name); it != std::sregex_iterator(); ++it) {
      add(it->str(1) + it->str(2) + it->str(3));
    }
    for (auto it = std::sregex_iterator(text.begin(), text.end(), kinds); it != std::sregex_iterator();
         ++it) {
      const std::string list = it->str(1);
      for (auto w = std::sregex_iterator(list.begin(), list.end(), word); w != std::sregex_iterator(); ++w) {
        add(w->str());
      }
    }
  }
  for (const path& file : tree::files(tree::root / "constraints")) {
    if (tree::is_code(file)) add(file.stem().string());
  }
  words.erase("");
  return words;
}

}  // namespace

TEST_CASE("the rooms of stepper, solvers and pattern name no effect") {
  std::set<std::string> words = effect_words();
  for (const char* word :
       {"cavity", "contact", "friction", "obstacle", "liquid", "rigid", "cable", "dirichlet"}) {
    INFO(word);
    CHECK(words.count(word) == 1);
  }
  for (const std::string& word : kGeneral) words.erase(word);
  const std::regex identifier("[A-Za-z_]\\w*");
  int files = 0;
  for (const std::string& room : kGuarded) {
    for (const path& file : tree::files(tree::root / room)) {
      if (!tree::is_code(file)) continue;
      ++files;
      const std::string text = code_of(tree::text_of(file));
      for (auto it = std::sregex_iterator(text.begin(), text.end(), identifier); it != std::sregex_iterator();
           ++it) {
        if (kNamesNone.count(it->str())) continue;
        for (const std::string& word : words_of(it->str())) {
          if (!words.count(word)) continue;
          INFO(tree::name_of(file) << " names an effect: " << it->str() << " (" << word << ")");
          CHECK(words.count(word) == 0);
        }
      }
    }
  }
  CHECK(files > 60);
}

TEST_CASE("the engine includes no effect, material or scheme") {
  const std::regex include("#include *\"(constraints|materials|integrators|scenes|apps|viewer)/");
  int seen = 0;
  for (const path& file : tree::files(tree::root / "engine")) {
    if (!tree::is_code(file)) continue;
    ++seen;
    for (const std::string& line : tree::lines_of(tree::text_of(file))) {
      INFO(tree::name_of(file) << ": " << line);
      CHECK_FALSE(std::regex_search(line, include));
    }
  }
  CHECK(seen > 30);
}
