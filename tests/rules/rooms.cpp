// Rule: a folder says what lives in it, and rooms include downward only. The table of rooms is the one that
// docs/architecture.md prints: this test reads it there.
#include <map>
#include <regex>

#include "rules/tree.h"

namespace {

using tree::fs::path;

struct Room {
  int floor = 0;
  std::set<std::string> includes;
};

// Rows "| `engine/solve/` | 4 | `base`, `system` |" between the marks of the table.
std::map<std::string, Room> rooms() {
  std::map<std::string, Room> found;
  bool inside = false;
  const std::regex row(R"(^\| `([\w/]+)/` \| (\d+) \|(.*)\|$)"), name("`([\\w/]+)`");
  for (const std::string& line : tree::lines_of(tree::text_of(tree::root / "docs" / "architecture.md"))) {
    if (line.find("<!-- rooms -->") != std::string::npos) inside = true;
    if (line.find("<!-- end of rooms -->") != std::string::npos) inside = false;
    std::smatch m;
    if (!inside || !std::regex_match(line, m, row)) continue;
    Room& room = found[m[1]];
    room.floor = std::stoi(m[2]);
    const std::string list = m[3];
    for (auto it = std::sregex_iterator(list.begin(), list.end(), name); it != std::sregex_iterator(); ++it) {
      room.includes.insert((*it)[1]);
    }
  }
  return found;
}

// The room of a file: the longest name in the table that its folder begins with; empty: none.
std::string room_of(const std::string& file, const std::map<std::string, Room>& all) {
  std::string best;
  for (const auto& [name, room] : all) {
    if (file.starts_with(name + "/") && name.size() > best.size()) best = name;
  }
  return best;
}

}  // namespace

TEST_CASE("rooms include what the table of the architecture says, and lower floors only") {
  const auto all = rooms();
  REQUIRE(all.size() > 8);
  for (const auto& [name, room] : all) {
    CHECK(tree::fs::is_directory(tree::root / name));
    for (const std::string& other : room.includes) {
      INFO(name << " may include " << other);
      REQUIRE(all.count(other) == 1);
      CHECK(all.at(other).floor < room.floor);  // hence no circles
    }
  }
  const std::regex include("^#include \"([\\w/]+\\.h)\"");
  for (const char* top : {"engine", "constraints", "materials", "integrators"}) {
    for (const path& file : tree::files(tree::root / top)) {
      if (!tree::is_code(file)) continue;
      const std::string name = tree::name_of(file), room = room_of(name, all);
      INFO(name << " is in no room of docs/architecture.md");
      REQUIRE_FALSE(room.empty());
      for (const std::string& line : tree::lines_of(tree::text_of(file))) {
        std::smatch m;
        if (!std::regex_search(line, m, include)) continue;
        const std::string other = room_of(m[1], all);
        if (other.empty() || other == room) continue;
        INFO(name << " includes " << m[1] << ", which docs/architecture.md does not allow");
        CHECK(all.at(room).includes.count(other) == 1);
      }
    }
  }
}

TEST_CASE("folders of the engine and of the constraints say what lives in them") {
  int seen = 0;
  for (const char* top : {"engine", "constraints"}) {
    std::set<path> folders{tree::root / top};
    for (const path& file : tree::files(tree::root / top)) folders.insert(file.parent_path());
    for (const path& folder : folders) {
      INFO(tree::name_of(folder) << "/README.md: some ten lines, what lives here and what to read first");
      CHECK(tree::fs::exists(folder / "README.md"));
      if (!tree::fs::exists(folder / "README.md")) continue;
      const std::size_t lines = tree::lines_of(tree::text_of(folder / "README.md")).size();
      INFO(lines << " lines");
      CHECK(lines >= 4);
      CHECK(lines <= 40);
      ++seen;
    }
  }
  CHECK(seen > 10);
}
