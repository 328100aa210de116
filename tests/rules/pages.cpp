// Rule: what the pages say of the tree is true. Files that they name are there, programs are those that are
// built, scenes and commands are understood.
#include <map>
#include <nlohmann/json.hpp>
#include <regex>

#include "rules/tree.h"

namespace {

using tree::fs::path;

struct Block {
  path page;
  std::string language, text;
};

std::vector<Block> blocks() {
  std::vector<Block> found;
  for (const path& page : tree::pages()) {
    bool inside = false;
    for (const std::string& line : tree::lines_of(tree::text_of(page))) {
      if (line.starts_with("```")) {
        inside = !inside;
        if (inside) found.push_back({page, line.substr(3), ""});
      } else if (inside) {
        found.back().text += line + "\n";
      }
    }
    INFO(tree::name_of(page) << " ends within a block");
    CHECK_FALSE(inside);
  }
  return found;
}

// Blanks do not count: a page may indent and break lines as it likes.
std::string squeezed(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (!std::isspace(static_cast<unsigned char>(c))) out += c;
  }
  return out;
}

// What runs leave behind, and places in examples.
bool made_by_a_run(const std::string& name) {
  static const std::set<std::string> known{
      "summary.json", "results.json", "fit.json",     "fit.csv",     "drive.json",
      "drive.csv",    "design.json",  "history.csv",  "targets.csv", "design.html",
      "field.csv",    "field.vtu",    "measured.csv", "fit_1.csv",   "tables.md",
      "scene.json",   "mesh.msh",     "my_mesh.msh",  "index.html",
      "pillow.json",  // the scene that docs/scenes.md builds up
      "tendon.cpp",   // where the worked example would go
      "abi.h"         // made by the build
  };
  return known.count(tree::fs::path(name).filename().string()) > 0;
}

bool is_there(const std::string& name, const path& page) {
  static const std::set<std::string> bare = [] {
    std::set<std::string> all;
    for (const path& file : tree::files()) all.insert(file.filename().string());
    return all;
  }();
  if (name.find('/') == std::string::npos) return bare.count(name) > 0;
  for (const path& from :
       {tree::root, page.parent_path(), tree::root / "include", tree::root / "scenes", tree::root / "engine",
        tree::root / "constraints", tree::root / "constraints" / "contact", tree::root / "tests"}) {
    if (tree::fs::exists(from / name)) return true;
  }
  return false;
}

void check_names(const std::string& text, const std::regex& pattern, const path& page, int& seen) {
  static const std::regex file(
      R"(^[\w./\-]*\w\.(h|cpp|md|cmake|json|mjs|msh|sh|svg|png)$|^(engine|constraints|materials|integrators|include|scenes|studies|tests|docs|apps|bench|viewer|fuzz|examples|cmake)/[\w./\-]*$)");
  for (auto it = std::sregex_iterator(text.begin(), text.end(), pattern); it != std::sregex_iterator();
       ++it) {
    const std::string name = (*it)[1];
    if (!std::regex_match(name, file) || made_by_a_run(name)) continue;
    if (name.find("NAME") != std::string::npos) continue;  // stands for any
    ++seen;
    INFO(tree::name_of(page) << " names " << name << ", which is not there");
    CHECK(is_there(name, page));
  }
}

}  // namespace

TEST_CASE("files that pages name are there") {
  const std::regex quoted("`([^`\\s]+)`"), link(R"(\]\(([^)#\s:]+)(?:#[^)]*)?\))");
  int names = 0, links = 0;
  for (const path& page : tree::pages()) {
    if (page.filename() == "CHANGELOG.md") continue;  // tells of what was
    const std::string text = tree::text_of(page);
    check_names(text, quoted, page, names);
    for (auto it = std::sregex_iterator(text.begin(), text.end(), link); it != std::sregex_iterator(); ++it) {
      const std::string to = (*it)[1];
      if (to.find_first_of("./") == std::string::npos) continue;  // f(x)[i](a, b) is no link
      ++links;
      INFO(tree::name_of(page) << " links to " << to);
      CHECK(tree::fs::exists(page.parent_path() / to));
    }
  }
  CHECK(names > 200);
  CHECK(links > 50);
}

TEST_CASE("files that comments of the build name are there") {
  const std::regex word(R"(([\w./\-]*\w))");
  int names = 0;
  for (const path& file : tree::files()) {
    if (file.filename() != "CMakeLists.txt" && file.extension() != ".cmake") continue;
    for (const std::string& line : tree::lines_of(tree::text_of(file))) {
      const auto hash = line.find("# ");
      if (hash != std::string::npos) check_names(line.substr(hash), word, file, names);
    }
  }
  CHECK(names > 5);
}

TEST_CASE("C++ and C in pages are parts of files that are compiled") {
  std::string compiled;
  for (const char* folder : {"examples", "tests/contract"}) {
    for (const path& file : tree::files(tree::root / folder)) {
      if (tree::is_code(file) || file.extension() == ".c") compiled += squeezed(tree::text_of(file)) + "\n";
    }
  }
  int seen = 0;
  for (const Block& block : blocks()) {
    if (block.language != "cpp" && block.language != "c") continue;
    ++seen;
    INFO(tree::name_of(block.page) << " has code that is in no file of examples/ or tests/contract/:\n"
                                   << block.text);
    CHECK(compiled.find(squeezed(block.text)) != std::string::npos);
  }
  CHECK(seen > 5);
}

TEST_CASE("JSON in pages is JSON, with keys that scene files know") {
  const std::string schema = tree::text_of(tree::root / "scenes" / "scene.schema.json");
  int seen = 0;
  for (const Block& block : blocks()) {
    if (block.language != "json") continue;
    ++seen;
    INFO(tree::name_of(block.page) << ":\n" << block.text);
    // A part of a scene stands without the braces around it.
    auto json = nlohmann::json::parse(block.text, nullptr, false, true);
    if (json.is_discarded()) json = nlohmann::json::parse("{" + block.text + "}", nullptr, false, true);
    REQUIRE_FALSE(json.is_discarded());
    if (!json.is_object()) continue;
    for (const auto& [key, value] : json.items()) {
      INFO("key " << key);
      CHECK(schema.find("\"" + key + "\"") != std::string::npos);
    }
  }
  CHECK(seen > 1);
}

TEST_CASE("commands in pages are commands of the tool, with options that it has") {
  std::string apps;
  for (const path& file : tree::files(tree::root / "apps")) apps += tree::text_of(file);
  const std::regex command(R"((?:^ {4}|`)(?:build/)?isochor ([a-z]+)([^`#\n]*))"),
      option(R"((--[a-z][a-z\-]*))");
  int seen = 0;
  for (const path& page : tree::pages()) {
    for (const std::string& line : tree::lines_of(tree::text_of(page))) {
      for (auto it = std::sregex_iterator(line.begin(), line.end(), command); it != std::sregex_iterator();
           ++it) {
        ++seen;
        INFO(tree::name_of(page) << ": " << it->str());
        CHECK(apps.find("add_subcommand(\"" + it->str(1) + "\"") != std::string::npos);
        const std::string rest = it->str(2);
        for (auto o = std::sregex_iterator(rest.begin(), rest.end(), option); o != std::sregex_iterator();
             ++o) {
          INFO("option " << o->str());
          CHECK(std::regex_search(apps, std::regex("[\",]" + o->str(1) + "[\",]")));
        }
      }
    }
  }
  CHECK(seen > 40);
}
