#include "studies/inverse/data.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "engine/base/text.h"
#include "engine/mesh/words.h"
#include "studies/table_row.h"

namespace isochor::inverse {

namespace {

using mesh_files::quoted;
using studies::cells_of;
using Kind = Quantity::Kind;

template <class List>
std::optional<std::size_t> find(const List& list, const std::string& name) {
  for (std::size_t k = 0; k < list.size(); ++k) {
    if (list[k].name == name) return k;
  }
  return std::nullopt;
}

template <class List>
void add_names(std::string& text, const List& list, const char* ends) {
  for (const auto& one : list) text += (text.empty() ? "" : ", ") + one.name + ends;
}

std::string columns_there_are(const SceneDef& scene) {
  std::string text;
  add_names(text, scene.probes, ".x");
  add_names(text, scene.cavities, ".volume");
  add_names(text, scene.cables, ".length");
  add_names(text, scene.dirichlet, ".force.x");
  add_names(text, scene.contacts, ".force.x");
  add_names(text, scene.surface_contacts, ".force.x");
  return text.empty() ? "none; add a probe to the scene" : text + ", ...";
}

// Where columns are and what they mean.
struct Header {
  std::size_t columns = 0;
  std::size_t time = 0;
  std::map<std::string, std::size_t> at;
  bool markers = false;
  std::vector<std::size_t> quantity_at;  // columns that are quantities, in the order of Data::quantities
};

Result<Header> read_header(const std::vector<std::string>& names, const SceneDef& scene,
                           const std::string& who, Data& out) {
  Header header;
  header.columns = names.size();
  for (std::size_t c = 0; c < names.size(); ++c) {
    if (!header.at.emplace(names[c], c).second)
      return Error{who + "column " + quoted(names[c]) + " is there twice; keep one"};
  }
  const auto has = [&](const char* name) { return header.at.count(name) > 0; };
  if (!has("time")) return Error{who + "there is no column \"time\"; name the columns in the first line"};
  header.time = header.at["time"];
  header.markers = has("X") && has("Y") && has("Z");
  if (header.markers) {
    for (const char* name : {"x", "y", "z"}) {
      if (!has(name)) return Error{who + "markers have no column " + quoted(name) + "; add where they were"};
    }
    for (const std::string& name : names) {
      const bool known = name == "time" || name == "body" || name == "X" || name == "Y" || name == "Z" ||
                         name == "x" || name == "y" || name == "z";
      if (!known)
        return Error{who + "column " + quoted(name) +
                     " beside markers; their columns are time, body, X, Y, Z, x, y, z"};
    }
    if (scene.bodies.size() > 1 && !has("body"))
      return Error{who + "the scene has several bodies; add a column \"body\" with their names"};
    return header;
  }
  for (std::size_t c = 0; c < names.size(); ++c) {
    if (c == header.time) continue;
    auto quantity = quantity_of(names[c], scene, who);
    if (!quantity) return quantity.failure();
    out.quantities.push_back(std::move(quantity).value());
    header.quantity_at.push_back(c);
  }
  if (out.quantities.empty())
    return Error{who + "there is no column beside \"time\"; there are " + columns_there_are(scene)};
  return header;
}

Result<void> take_marker(const std::vector<std::string>& cells, const Header& header, const SceneDef& scene,
                         const std::string& who, Data& out) {
  const auto vector = [&](std::array<const char*, 3> names) -> Result<Vec3> {
    Vec3 v{};
    for (int k = 0; k < 3; ++k) {
      auto value = number_in(cells[header.at.at(names[static_cast<std::size_t>(k)])], who);
      if (!value) return value.failure();
      v[k] = value.value();
    }
    return v;
  };
  const auto rest = vector({"X", "Y", "Z"});
  if (!rest) return rest.failure();
  const auto seen = vector({"x", "y", "z"});
  if (!seen) return seen.failure();
  std::size_t body = 0;
  if (header.at.count("body") > 0) {
    const std::string& name = cells[header.at.at("body")];
    const auto found = find(scene.bodies, name);
    if (!found) return Error{who + "the scene has no body " + quoted(name)};
    body = *found;
  }
  for (int k = 0; k < 3; ++k) {
    const std::string name = "marker " + number(rest.value().x) + " " + number(rest.value().y) + " " +
                             number(rest.value().z) + "." + std::string(1, "xyz"[k]);
    out.values.push_back({out.time.size() - 1, out.quantities.size(), seen.value()[k]});
    out.quantities.push_back({name, Kind::position, body, k, rest.value()});
  }
  return {};
}

Result<void> take_line(const std::vector<std::string>& cells, const Header& header, const SceneDef& scene,
                       const std::string& who, Data& out) {
  if (cells.size() > header.columns) {
    return Error{who + std::to_string(cells.size()) + " columns, the header has " +
                 std::to_string(header.columns) + "; give a number in each"};
  }
  // A line whose last cells are empty is shorter than the header.
  std::vector<std::string> all = cells;
  all.resize(header.columns);
  const auto time = number_in(all[header.time], who);
  if (!time) return time.failure();
  const double before = out.time.empty() ? 0 : out.time.back();
  const bool same = header.markers && !out.time.empty() && time.value() == before;
  if (!same && !(time.value() > before)) {
    return Error{who + "time " + number(time.value()) + " is not after " + number(before) +
                 "; times of the scene ascend, and it begins at 0"};
  }
  if (!same) out.time.push_back(time.value());
  if (header.markers) return take_marker(all, header, scene, who, out);
  for (std::size_t q = 0; q < header.quantity_at.size(); ++q) {
    const std::string& cell = all[header.quantity_at[q]];
    if (cell.empty()) continue;
    const auto value = number_in(cell, who);
    if (!value) return value.failure();
    out.values.push_back({out.time.size() - 1, q, value.value()});
  }
  return {};
}

}  // namespace

const char* unit_of(Kind kind) {
  switch (kind) {
    case Kind::volume:
      return "m^3";
    case Kind::pressure:
      return "Pa";
    case Kind::tension:
    case Kind::force:
    case Kind::contact:
    case Kind::surface_contact:
      return "N";
    case Kind::moment:
      return "N m";
    default:
      return "m";
  }
}

Result<double> number_in(const std::string& cell, const std::string& who) {
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
    return Error{who + quoted(cell) + " is no finite number; give one, or leave out what was not measured"};
  return value;
}

Result<Quantity> quantity_of(const std::string& column, const SceneDef& scene, const std::string& who) {
  const auto dot = column.rfind('.');
  const std::string last = dot == std::string::npos ? "" : column.substr(dot + 1);
  const std::string name = column.substr(0, dot);
  const std::string axes = "xyz";
  const Error unknown{who + "column " + quoted(column) + " is none of the scene; it has " +
                      columns_there_are(scene)};
  if (last == "volume" || last == "pressure") {
    const auto found = find(scene.cavities, name);
    if (!found) return unknown;
    return Quantity{column, last == "volume" ? Kind::volume : Kind::pressure, *found, 0};
  }
  if (last == "length" || last == "tension") {
    const auto found = find(scene.cables, name);
    if (!found) return unknown;
    return Quantity{column, last == "length" ? Kind::length : Kind::tension, *found, 0};
  }
  if (last.size() != 1 || axes.find(last) == std::string::npos) return unknown;
  const int component = static_cast<int>(axes.find(last));
  const auto middle = name.rfind('.');
  const std::string vector = middle == std::string::npos ? "" : name.substr(middle + 1);
  if (vector == "force" || vector == "moment") {
    const std::string of = name.substr(0, middle);
    if (const auto found = find(scene.dirichlet, of))
      return Quantity{column, vector == "force" ? Kind::force : Kind::moment, *found, component};
    if (vector == "moment") return unknown;
    if (const auto found = find(scene.surface_contacts, of))
      return Quantity{column, Kind::surface_contact, *found, component};
    const auto found = find(scene.contacts, of);
    if (!found) return unknown;
    if (!scene.contacts[*found].rigid.empty())
      return Error{who + "column " + quoted(column) +
                   ": that contact is of a rigid body; name one of a soft body"};
    return Quantity{column, Kind::contact, *found, component};
  }
  const auto found = find(scene.probes, name);
  if (!found) {
    std::string probes;
    for (const ProbeDef& p : scene.probes) probes += (probes.empty() ? "\"" : ", \"") + p.name + "\"";
    return Error{who + "column " + quoted(column) + ": the scene has no probe " + quoted(name) + "; it has " +
                 (probes.empty() ? "none; add one to the scene" : probes)};
  }
  return Quantity{column, Kind::position, *found, component};
}

Result<Data> parse_data(const std::string& text, const std::string& source, const SceneDef& scene) {
  Data out;
  out.source = source;
  std::optional<Header> header;
  std::stringstream lines(text);
  int number_of = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number_of;
    if (studies::trimmed(line).empty()) continue;
    const std::string who = source + ":" + std::to_string(number_of) + ": ";
    const std::vector<std::string> cells = cells_of(number_of == 1 ? studies::without_mark(line) : line);
    if (!header) {
      auto found = read_header(cells, scene, who, out);
      if (!found) return found.failure();
      header = std::move(found).value();
      continue;
    }
    if (auto r = take_line(cells, *header, scene, who, out); !r) return r.failure();
  }
  if (!header) return Error{source + ": it is empty; the first line names the columns"};
  if (out.values.empty()) return Error{source + ": there is no number; add lines below the header"};
  return out;
}

Result<Data> read_data(const std::string& path, const SceneDef& scene) {
  std::ifstream file(path);
  if (!file) return Error{path + ": cannot be opened; mind the path"};
  std::stringstream text;
  text << file.rdbuf();
  return parse_data(text.str(), path, scene);
}

}  // namespace isochor::inverse
