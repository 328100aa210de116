#include "studies/drive/targets.h"

#include <fstream>
#include <sstream>

#include "engine/base/text.h"
#include "engine/mesh/words.h"
#include "studies/table_row.h"

namespace isochor::drive {

namespace {

using mesh_files::quoted;
using studies::cells_of;

Result<std::size_t> read_header(const std::vector<std::string>& header, const SceneDef& scene,
                                const std::string& who, Targets& out) {
  std::size_t time = header.size();
  for (std::size_t c = 0; c < header.size(); ++c) {
    for (std::size_t k = 0; k < c; ++k) {
      if (header[k] == header[c])
        return Error{who + "column " + quoted(header[c]) + " is there twice; keep one"};
    }
    if (header[c] == "time") {
      time = c;
      continue;
    }
    auto goal = inverse::quantity_of(header[c], scene, who);
    if (!goal) return goal.failure();
    out.goals.push_back(std::move(goal).value());
  }
  if (time == header.size()) return Error{who + "there is no column \"time\"; add one"};
  if (out.goals.empty())
    return Error{who + "there is no target; add a column for a component of a probe, such as \"tip.x\""};
  return time;
}

}  // namespace

Result<Targets> parse_targets(const std::string& text, const std::string& source, const SceneDef& scene) {
  Targets out;
  std::stringstream lines(text);
  std::string line;
  int number_of_line = 0;
  std::size_t time = 0, columns = 0;
  while (std::getline(lines, line)) {
    ++number_of_line;
    const auto cells = cells_of(number_of_line == 1 ? studies::without_mark(line) : line);
    if (cells.empty() || (cells.size() == 1 && cells[0].empty())) continue;
    const std::string who = source + ", line " + std::to_string(number_of_line) + ": ";
    if (columns == 0) {
      auto found = read_header(cells, scene, who, out);
      if (!found) return found.failure();
      time = found.value();
      columns = cells.size();
      continue;
    }
    if (cells.size() != columns) {
      return Error{who + std::to_string(cells.size()) + " columns, the header has " +
                   std::to_string(columns) + "; give a number in each"};
    }
    std::vector<double> goals;
    for (std::size_t c = 0; c < columns; ++c) {
      auto value = inverse::number_in(cells[c], who);
      if (!value) return value.failure();
      if (c != time) {
        goals.push_back(value.value());
        continue;
      }
      const double before = out.time.empty() ? 0 : out.time.back();
      if (!(value.value() > before)) {
        return Error{who + "time " + number(value.value()) + " is not after " + number(before) +
                     "; times of the scene ascend, and it begins at 0"};
      }
      out.time.push_back(value.value());
    }
    out.value.push_back(std::move(goals));
  }
  if (columns == 0) return Error{source + ": it is empty; the first line names the columns"};
  if (out.time.empty()) return Error{source + ": there is no target; add lines below the header"};
  return out;
}

Result<Targets> read_targets(const std::string& path, const SceneDef& scene) {
  std::ifstream file(path);
  if (!file) return Error{path + ": cannot be opened; mind the path"};
  std::stringstream text;
  text << file.rdbuf();
  return parse_targets(text.str(), path, scene);
}

}  // namespace isochor::drive
