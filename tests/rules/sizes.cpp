// Rule: no function over 80 lines, no class of more than 25 data members. What is longer is several things.
#include <cctype>
#include <regex>

#include "tree.h"

namespace {

constexpr int kMostLines = 80, kMostMembers = 25;

// Code without comments and directives, texts empty; lines stay where they are.
std::string bare(const std::string& code) {
  std::string out;
  const std::size_t n = code.size();
  const auto skip_to = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < std::min(to, n); ++i) {
      if (code[i] == '\n') out += '\n';
    }
    return to;
  };
  const auto end_of = [&](std::size_t from, const std::string& what) {
    const std::size_t found = code.find(what, from);
    return found == std::string::npos ? n : found;
  };
  for (std::size_t i = 0; i < n;) {
    const char c = code[i];
    const bool first = i == 0 || code[i - 1] == '\n';
    if (code.compare(i, 2, "//") == 0) {
      i = skip_to(i, end_of(i, "\n"));
    } else if (code.compare(i, 2, "/*") == 0) {
      i = skip_to(i, end_of(i, "*/") + 2);
    } else if (c == '#' && first) {
      std::size_t end = end_of(i, "\n");
      while (end < n && code[end - 1] == '\\') end = end_of(end + 1, "\n");
      i = skip_to(i, end);
    } else if (code.compare(i, 2, "R\"") == 0) {
      const std::size_t open = end_of(i, "(");
      std::string close(1, ')');
      close.append(code, i + 2, open - i - 2).append(1, '"');
      i = skip_to(i, end_of(open, close) + close.size());
      out += "\"\"";
    } else if (c == '"' ||
               (c == '\'' && (i == 0 || !std::isalnum(static_cast<unsigned char>(code[i - 1]))))) {
      std::size_t end = i + 1;
      while (end < n && code[end] != c) end += code[end] == '\\' ? 2 : 1;
      i = end + 1;
      out += "0";
    } else {
      out += c;
      ++i;
    }
  }
  return out;
}

struct Finding {
  int line = 0;
  std::string what;
};

enum class Kind { space, type, function, other };

struct Open {
  Kind kind = Kind::other;
  std::string head;
  int line = 1, members = 0;
};

Kind kind_of(const std::string& head, Kind around) {
  static const std::regex space("\\bnamespace\\b[^()]*$|^\\s*extern\\s*0\\s*$");
  static const std::regex type("\\b(class|struct|union)\\s+[^()=]*$");
  static const std::regex enumeration("\\benum\\b");
  if (std::regex_search(head, space)) return Kind::space;
  if (std::regex_search(head, enumeration)) return Kind::other;
  if (std::regex_search(head, type)) return Kind::type;
  const bool outside = around == Kind::space || around == Kind::type;
  return outside && head.find('(') != std::string::npos ? Kind::function : Kind::other;
}

// How many data members a declaration in a class declares.
int members_in(std::string text) {
  static const std::regex access("^\\s*(public|private|protected)\\s*:");
  static const std::regex none(
      "^\\s*(using|friend|typedef|static|template|enum|struct\\s+\\w+\\s*$|class\\s+\\w+\\s*$|$)");
  static const std::regex arguments("<[^<>]*>");
  while (std::regex_search(text, access)) text = std::regex_replace(text, access, "");
  if (std::regex_search(text, none)) return 0;
  text = text.substr(0, text.find('='));
  for (std::string inner = text;; text = inner) {
    inner = std::regex_replace(text, arguments, "");
    if (inner == text) break;
  }
  if (text.find('(') != std::string::npos || text.find("operator") != std::string::npos) return 0;
  return 1 + static_cast<int>(std::count(text.begin(), text.end(), ','));
}

std::vector<Finding> too_large(const std::string& code) {
  std::vector<Finding> found;
  std::vector<Open> open;
  std::string head;
  int line = 1;
  const auto around = [&] { return open.empty() ? Kind::space : open.back().kind; };
  for (const char c : bare(code)) {
    if (c == '\n') ++line;
    if (c == '{') {
      open.push_back({kind_of(head, around()), head, line, 0});
      head.clear();
    } else if (c == '}' && !open.empty()) {
      const Open block = open.back();
      open.pop_back();
      const int lines = line - block.line + 1;
      if (block.kind == Kind::function && lines > kMostLines)
        found.push_back({block.line, std::to_string(lines) + " lines"});
      if (block.kind == Kind::type && block.members > kMostMembers)
        found.push_back({block.line, std::to_string(block.members) + " members"});
      // What a block initializes goes on to its semicolon.
      head = block.kind == Kind::other ? block.head + "=" : std::string();
    } else if (c == ';') {
      if (around() == Kind::type) open.back().members += members_in(head);
      head.clear();
    } else {
      head += c;
    }
  }
  return found;
}

std::string text_with(int lines, int members) {
  std::string code = "namespace a {\nclass B {\n public:\n  int f(std::map<int, int> m) {\n";
  for (int i = 0; i < lines - 2; ++i) code += "    // {\n";
  code += "  }\n  enum class C { one, two };\n  static int g();\n private:\n";
  for (int i = 0; i < members; ++i) code += "  std::pair<int, double> m" + std::to_string(i) + "_{1, 2};\n";
  return code + "};\n}\n";
}

}  // namespace

TEST_CASE("functions that are too long and classes with too many members are found") {
  CHECK(too_large(text_with(kMostLines, kMostMembers)).empty());
  REQUIRE(too_large(text_with(kMostLines + 1, 0)).size() == 1);
  CHECK(too_large(text_with(kMostLines + 1, 0))[0].line == 4);
  REQUIRE(too_large(text_with(3, kMostMembers + 1)).size() == 1);
  CHECK(too_large(text_with(3, kMostMembers + 1))[0].what == std::to_string(kMostMembers + 1) + " members");
}

TEST_CASE("no function is longer than 80 lines and no class has more than 25 data members") {
  int seen = 0;
  for (const char* room : {"include", "engine", "constraints", "materials", "integrators", "scenes", "live",
                           "studies", "viewer", "apps", "bindings", "bench", "fuzz", "examples"}) {
    for (const auto& file : tree::files(tree::root / room)) {
      if (!tree::is_code(file)) continue;
      ++seen;
      for (const Finding& f : too_large(tree::text_of(file)))
        FAIL_CHECK(tree::name_of(file) << ":" << f.line << ": " << f.what);
    }
  }
  CHECK(seen > 400);
}
