// Abaqus and CalculiX decks (.inp): nodes, solid elements, sets and surfaces of one part. The rest of a model
// is skipped.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>

#include "engine/base/chars.h"
#include "engine/mesh/cell_shape.h"
#include "engine/mesh/read/readers.h"

namespace isochor::mesh_files {

namespace {

// Sides S1, S2, ... by corners.
constexpr std::array<std::array<std::size_t, 3>, 4> kTetSides{{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};
constexpr std::array<std::array<std::size_t, 4>, 6> kHexSides{
    {{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1}, {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}}};

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::string upper(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  return out;
}

std::vector<std::string_view> fields(std::string_view line) {
  std::vector<std::string_view> out;
  for (std::size_t from = 0; from <= line.size();) {
    const std::size_t comma = std::min(line.find(',', from), line.size());
    out.push_back(trimmed(line.substr(from, comma - from)));
    from = comma + 1;
  }
  // A line may end in a comma.
  if (out.size() > 1 && out.back().empty()) out.pop_back();
  return out;
}

struct Element {
  std::int64_t label = 0;
  std::size_t nodes = 0;  // how many, at `first` in AbaqusFile::node_numbers
  std::size_t first = 0;
  bool solid = false;
  std::string set;  // upper case; empty: none
};

struct AbaqusFile {
  Cursor at;
  RawMesh raw;
  LabelMap node_index;
  std::vector<Element> elements;
  std::vector<std::int64_t> node_numbers;
  std::map<std::string, std::vector<std::int64_t>> element_sets, node_sets;  // by name in upper case
  std::map<std::string, std::string> shown_name;                             // as the file spells it
  std::vector<std::pair<std::string, std::vector<std::pair<std::string, std::string>>>> surfaces;
  std::vector<std::string> sections;  // sets that have a material
  int instances = 0;
  bool in_assembly = false, in_instance = false;
};

// "*ELEMENT, TYPE=C3D4, ELSET=wall" as its first word and its parameters, both in upper case but for values.
struct Keyword {
  std::string name;
  std::map<std::string, std::string> parameters;
  std::string get(const char* key) const {
    const auto found = parameters.find(key);
    return found == parameters.end() ? std::string() : found->second;
  }
};

// The next data line, or nothing where a keyword or the end follows. Comments are skipped.
std::optional<std::string_view> data_line(AbaqusFile& f) {
  for (;;) {
    f.at.skip_space();
    if (f.at.at_end()) return std::nullopt;
    const std::string_view rest = f.at.rest();
    const bool comment = rest.starts_with("**");
    if (!comment && rest.front() == '*') return std::nullopt;
    const std::string_view line = f.at.line("a line");
    if (!comment) return trimmed(line);
  }
}

Keyword read_keyword(AbaqusFile& f) {
  std::string line(trimmed(f.at.line("a keyword")));
  while (line.ends_with(',')) {
    const auto more = data_line(f);
    if (!more) break;
    line += *more;
  }
  Keyword keyword;
  const auto parts = fields(line);
  keyword.name = upper(parts[0].substr(1));
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const std::size_t equals = parts[i].find('=');
    const std::string_view value =
        equals == parts[i].npos ? std::string_view() : trimmed(parts[i].substr(equals + 1));
    std::string_view bare = value;
    if (bare.size() > 1 && bare.front() == '"' && bare.back() == '"') bare = bare.substr(1, bare.size() - 2);
    keyword.parameters[upper(trimmed(parts[i].substr(0, equals)))] = bare;
  }
  return keyword;
}

template <class T>
T number(AbaqusFile& f, std::string_view text, const char* what) {
  T value{};
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, status] = isochor::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size())
    f.at.fail(join(what, " should be a number but reads ", quoted(text)), rewrite_file);
  return value;
}

std::string remember(AbaqusFile& f, const std::string& name) {
  f.shown_name.try_emplace(upper(name), name);
  return upper(name);
}

void read_nodes(AbaqusFile& f, const Keyword& keyword) {
  const std::string set = keyword.get("NSET");
  while (const auto line = data_line(f)) {
    const auto parts = fields(*line);
    f.raw.node_label.push_back(number<std::int64_t>(f, parts[0], "a node number"));
    Vec3 x;
    for (std::size_t k = 1; k < std::min<std::size_t>(parts.size(), 4); ++k) {
      if (!parts[k].empty()) x[static_cast<int>(k) - 1] = number<double>(f, parts[k], "a coordinate");
    }
    if (!std::isfinite(dot(x, x))) f.at.fail("a coordinate is not finite", "repair the file");
    f.raw.nodes.push_back(x);
    if (!set.empty()) f.node_sets[remember(f, set)].push_back(f.raw.node_label.back());
  }
}

// Nodes an element, 0 for what is neither a solid nor a triangle or quadrangle.
std::size_t nodes_of_type(const std::string& type, bool& solid) {
  solid = type.starts_with("C3D");
  std::size_t first = solid ? 3 : type.find_last_of("0123456789");
  if (first == std::string::npos) return 0;
  if (!solid && first > 0 && std::isdigit(static_cast<unsigned char>(type[first - 1]))) return 0;
  std::size_t count = 0;
  std::from_chars(type.data() + first, type.data() + type.size(), count);
  const bool flat = (type.starts_with("S") && !type.starts_with("SC")) || type.starts_with("M3D") ||
                    type.starts_with("CPS") || type.starts_with("CPE");
  if (!solid && !(flat && (count == 3 || count == 4 || count == 6))) return 0;
  return count;
}

void read_elements(AbaqusFile& f, const Keyword& keyword) {
  const std::string type = upper(keyword.get("TYPE")), set = keyword.get("ELSET");
  bool solid = false;
  const std::size_t count = nodes_of_type(type, solid);
  const bool known = solid ? count == 4 || count == 8 || count == 10 : count > 0;
  std::vector<std::int64_t> numbers;
  while (const auto line = data_line(f)) {
    for (const std::string_view part : fields(*line)) {
      if (!part.empty()) numbers.push_back(number<std::int64_t>(f, part, "a number of an element"));
    }
    const bool whole = known ? numbers.size() >= count + 1 : !line->ends_with(',');
    if (!whole) continue;
    if (known && numbers.size() > count + 1)
      f.at.fail(
          join("element ", numbers[0], " has ", numbers.size() - 1, " nodes, and ", type, " has ", count),
          rewrite_file);
    if (known) {
      f.elements.push_back(
          {numbers[0], count, f.node_numbers.size(), solid, set.empty() ? "" : remember(f, set)});
      f.node_numbers.insert(f.node_numbers.end(), numbers.begin() + 1, numbers.end());
      if (!set.empty()) f.element_sets[upper(set)].push_back(numbers[0]);
    } else if (solid) {
      ++f.raw.foreign_cells[type];
    } else {
      ++f.raw.flat_cells;
    }
    numbers.clear();
  }
  if (!numbers.empty()) f.at.fail(join("element ", numbers[0], " ends early"), rewrite_file);
}

// Numbers and names of other sets, or ranges of numbers.
void read_set(AbaqusFile& f, const Keyword& keyword, const char* key,
              std::map<std::string, std::vector<std::int64_t>>& sets) {
  const std::string name = keyword.get(key);
  if (name.empty()) f.at.fail(join("*", keyword.name, " has no ", key, "="), "name the set");
  const bool ranges = keyword.parameters.count("GENERATE") > 0;
  std::vector<std::int64_t> members;
  while (const auto line = data_line(f)) {
    const auto parts = fields(*line);
    if (ranges) {
      const auto first = number<std::int64_t>(f, parts[0], "the first number"),
                 last = parts.size() > 1 ? number<std::int64_t>(f, parts[1], "the last number") : first,
                 step = parts.size() > 2 ? number<std::int64_t>(f, parts[2], "the step") : 1;
      // Sets come behind what they hold, and a short file cannot ask for much memory.
      const auto most = static_cast<std::int64_t>(64 * (f.raw.nodes.size() + f.elements.size()) + 1000);
      if (step < 1 || first < 0 || last < first || last > (std::int64_t{1} << 40) ||
          (last - first) / step > most)
        f.at.fail(join("the range ", first, ", ", last, ", ", step, " makes no sense"), rewrite_file);
      for (std::int64_t n = first; n <= last; n += step) members.push_back(n);
      continue;
    }
    for (std::string_view part : parts) {
      if (part.empty()) continue;
      if (const std::size_t dot_at = part.find('.'); dot_at != part.npos) part.remove_prefix(dot_at + 1);
      const bool is_number = part.find_first_not_of("0123456789") == part.npos && !part.empty();
      if (is_number) {
        members.push_back(number<std::int64_t>(f, part, "a member of a set"));
      } else if (const auto other = sets.find(upper(part)); other != sets.end()) {
        members.insert(members.end(), other->second.begin(), other->second.end());
      }
    }
  }
  auto& set = sets[remember(f, name)];
  set.insert(set.end(), members.begin(), members.end());
  std::sort(set.begin(), set.end());
  set.erase(std::unique(set.begin(), set.end()), set.end());
}

void read_surface(AbaqusFile& f, const Keyword& keyword) {
  const std::string type = upper(keyword.get("TYPE"));
  auto& surface = f.surfaces.emplace_back();
  surface.first = keyword.get("NAME");
  while (const auto line = data_line(f)) {
    const auto parts = fields(*line);
    if (!type.empty() && type != "ELEMENT") continue;
    std::string_view what = parts[0];
    if (const std::size_t dot_at = what.find('.'); dot_at != what.npos) what.remove_prefix(dot_at + 1);
    surface.second.emplace_back(upper(what), parts.size() > 1 ? upper(parts[1]) : "");
  }
  if (surface.second.empty()) f.surfaces.pop_back();
}

void read_instance(AbaqusFile& f) {
  f.in_instance = true;
  if (++f.instances > 1)
    f.at.fail("the deck has several instances", "write one part to a file of its own, or a flat deck");
  if (data_line(f))
    f.at.fail("the instance is moved by numbers behind *INSTANCE", "write a flat deck, without parts");
}

void read_keyword_data(AbaqusFile& f) {
  const Keyword keyword = read_keyword(f);
  f.at.set_section("*" + keyword.name);
  if (keyword.name == "ASSEMBLY") f.in_assembly = true;
  if (keyword.name == "END ASSEMBLY") f.in_assembly = false;
  if (keyword.name == "END INSTANCE") f.in_instance = false;
  // Reference points of an assembly are numbered anew, and no part of a body.
  const bool reference = f.in_assembly && !f.in_instance;
  if (keyword.name == "NODE" && !reference) return read_nodes(f, keyword);
  if (keyword.name == "ELEMENT" && !reference) return read_elements(f, keyword);
  if (keyword.name == "NSET") return read_set(f, keyword, "NSET", f.node_sets);
  if (keyword.name == "ELSET") return read_set(f, keyword, "ELSET", f.element_sets);
  if (keyword.name == "SURFACE") return read_surface(f, keyword);
  if (keyword.name == "INSTANCE") return read_instance(f);
  if (keyword.name == "INCLUDE") f.at.fail("*INCLUDE names another file", "put all into one file");
  if (keyword.name == "SOLID SECTION" && !keyword.get("ELSET").empty())
    f.sections.push_back(upper(keyword.get("ELSET")));
  while (data_line(f)) {
  }
}

std::vector<Index> nodes_of(AbaqusFile& f, const Element& e) {
  std::vector<Index> nodes;
  for (std::size_t k = 0; k < e.nodes; ++k) {
    const std::int64_t number = f.node_numbers[e.first + k];
    nodes.push_back(f.node_index.find(number));
    if (nodes.back() < 0)
      f.at.fail(join("element ", e.label, " names node ", number, ", which is not defined"), rewrite_file);
  }
  return nodes;
}

// Regions are the sets that have a section; without any, the sets that the elements were defined in.
std::map<std::int64_t, std::int64_t> regions_of(AbaqusFile& f) {
  std::map<std::int64_t, std::int64_t> region;  // of an element
  std::map<std::string, std::int64_t> number;
  const auto number_of = [&](const std::string& set) {
    const auto [it, fresh] = number.try_emplace(set, static_cast<std::int64_t>(number.size()) + 1);
    if (fresh) f.raw.region_name[it->second] = f.shown_name.count(set) > 0 ? f.shown_name[set] : set;
    return it->second;
  };
  for (const std::string& set : f.sections) {
    const auto found = f.element_sets.find(set);
    if (found == f.element_sets.end()) continue;
    const std::int64_t own = number_of(set);
    for (const std::int64_t e : found->second) region.try_emplace(e, own);
  }
  for (const Element& e : f.elements) {
    if (f.sections.empty() && e.solid && !e.set.empty()) region.try_emplace(e.label, number_of(e.set));
  }
  return region;
}

void add_side(AbaqusFile& f, std::int64_t tag, const Element& e, const std::string& side) {
  if (!e.solid || side.size() != 2 || side[0] != 'S' || side[1] < '1' || side[1] > (e.nodes == 8 ? '6' : '4'))
    return;
  const auto s = static_cast<std::size_t>(side[1] - '1');
  const std::vector<Index> nodes = nodes_of(f, e);
  std::vector<Index> face;
  if (e.nodes == 8) {
    for (const std::size_t k : kHexSides[s]) face.push_back(nodes[k]);
  } else {
    for (const std::size_t k : kTetSides[s]) face.push_back(nodes[k]);
  }
  f.raw.add_face(f.at, tag, face);
}

void add_surfaces(AbaqusFile& f) {
  std::map<std::int64_t, std::size_t> place;
  for (std::size_t i = 0; i < f.elements.size(); ++i) place[f.elements[i].label] = i;
  std::int64_t tag = 0;
  const auto one = [&](std::int64_t label, const std::string& side) {
    if (const auto found = place.find(label); found != place.end())
      add_side(f, tag, f.elements[found->second], side);
  };
  for (const auto& [name, parts] : f.surfaces) {
    f.raw.surface_name[++tag] = name;
    for (const auto& [what, side] : parts) {
      if (const auto set = f.element_sets.find(what); set != f.element_sets.end()) {
        for (const std::int64_t label : set->second) one(label, side);
      } else if (what.find_first_not_of("0123456789") == what.npos && !what.empty() && what.size() < 18) {
        one(std::stoll(what), side);
      }
    }
  }
  // Shells and membranes stand for the surface that they cover.
  std::map<std::string, std::int64_t> of_set;
  for (const Element& e : f.elements) {
    if (e.solid) continue;
    ++f.raw.flat_cells;
    if (e.set.empty()) continue;
    const auto [it, fresh] = of_set.try_emplace(e.set, tag + 1);
    if (fresh) f.raw.surface_name[++tag] = f.shown_name[e.set];
    f.raw.add_face(f.at, it->second, nodes_of(f, e));
  }
}

}  // namespace

bool is_abaqus(std::string_view content) {
  while (content.starts_with("**")) {
    const std::size_t end = content.find('\n');
    if (end == content.npos) return false;
    content.remove_prefix(end + 1);
  }
  if (!content.starts_with("*")) return false;
  const std::string text = upper(content.substr(0, 1 << 20));
  return text.find("*NODE") != text.npos && !text.starts_with("*KEYWORD");
}

RawMesh read_abaqus(std::string_view content, const std::string& file) {
  AbaqusFile f{Cursor(content, file), {}, {}, {}, {}, {}, {}, {}, {}, {}, 0, false, false};
  f.raw.file = file;
  while (data_line(f)) {
  }
  while (!f.at.at_end()) {
    read_keyword_data(f);
    f.at.skip_space();
  }
  f.at.set_section("");
  f.at.forget_place();
  const auto [unique, label] = f.node_index.build(f.raw.node_label);
  if (!unique)
    f.at.fail(join("node ", label, " is defined twice"),
              "write one part to a file of its own, or a flat deck");
  const auto region = regions_of(f);
  for (const Element& e : f.elements) {
    if (!e.solid) continue;
    const auto own = region.find(e.label);
    f.raw.add_cell(f.at, e.label, own == region.end() ? no_tag : own->second, nodes_of(f, e), vtk_tet10);
  }
  add_surfaces(f);
  std::int64_t number = 0;
  for (const auto& [name, members] : f.node_sets) {
    MeshNodeSet set{f.shown_name[name], {}};
    for (const std::int64_t n : members) {
      if (const Index i = f.node_index.find(n); i >= 0) set.nodes.push_back(i);
    }
    f.raw.node_sets[{0, ++number}] = std::move(set);
  }
  return std::move(f.raw);
}

}  // namespace isochor::mesh_files
