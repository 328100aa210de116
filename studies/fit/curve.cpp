#include "studies/fit/curve.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "studies/table_row.h"

namespace isochor::fit {

namespace {

using studies::cells_of;
using studies::trimmed;

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool has(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

struct Columns {
  std::size_t strain = 0, stress = 0;
  bool stretch = false, true_strain = false, true_stress = false;
  double strain_scale = 1, stress_scale = 0;
  char separator = ',';
};

double unit_of(const std::string& name) {
  if (has(name, "mpa") || has(name, "n/mm")) return 1e6;
  if (has(name, "kpa")) return 1e3;
  if (has(name, "gpa")) return 1e9;
  if (has(name, "(pa") || has(name, "[pa") || name == "pa") return 1;
  return 0;
}

// Which column of a header serves; npos: none.
std::size_t column(const std::vector<std::string>& header, const std::string& asked, bool stress) {
  std::size_t found = std::string::npos;
  for (std::size_t i = 0; i < header.size(); ++i) {
    const std::string name = lower(header[i]);
    if (!asked.empty()) {
      if (name == lower(asked)) return i;
      continue;
    }
    const bool fits = stress ? has(name, "stress") : has(name, "strain") || has(name, "stretch");
    if (!fits) continue;
    // Engineering numbers are what was measured; true ones were made from them.
    const bool engineering = has(name, "eng") || has(name, "nominal");
    if (found == std::string::npos || engineering) found = i;
  }
  return found;
}

// The columns of a line that is a header; nothing where it is none.
std::optional<Columns> header_in(const std::string& line, const CurveOptions& options) {
  for (const char separator : {';', '\t', ','}) {
    const std::vector<std::string> cells = cells_of(line, separator);
    const std::size_t strain = column(cells, options.strain_column, false),
                      stress = column(cells, options.stress_column, true);
    if (cells.size() < 2 || strain == std::string::npos || stress == std::string::npos || strain == stress)
      continue;
    const std::string x = lower(cells[strain]), y = lower(cells[stress]);
    Columns c;
    c.separator = separator;
    c.strain = strain;
    c.stress = stress;
    c.stretch = has(x, "stretch");
    c.true_strain = has(x, "true") || has(x, "log");
    c.true_stress = has(y, "true") || has(y, "cauchy");
    c.strain_scale = has(x, "%") ? 0.01 : 1;
    c.stress_scale = options.stress_unit.empty() ? unit_of(y) : unit_of(lower("(" + options.stress_unit));
    return c;
  }
  return std::nullopt;
}

std::optional<double> number_in(std::string text, char separator) {
  if (separator == ';') std::replace(text.begin(), text.end(), ',', '.');  // decimal commas
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

// Stretch along the load by what the mode keeps, nominal from true stress.
void append(const Columns& c, double x, double y, Curve& curve) {
  const double stretch = c.true_strain ? std::exp(x) : (c.stretch ? x : 1 + x);
  curve.stretch.push_back(stretch);
  curve.stress.push_back(c.true_stress ? y / stretch : y);
}

// Points beyond the range, and those longer than at the largest stress: there the specimen fails.
void select(const CurveOptions& options, Curve& curve) {
  const auto peak = std::max_element(curve.stress.begin(), curve.stress.end()) - curve.stress.begin();
  const double failure = curve.stretch[static_cast<std::size_t>(peak)];
  Curve kept{curve.name, curve.mode, {}, {}, {}};
  std::size_t after = 0, outside = 0;
  for (std::size_t i = 0; i < curve.stretch.size(); ++i) {
    const double strain = curve.stretch[i] - 1;
    if (!options.highest && curve.stretch[i] > failure) {
      ++after;
    } else if ((options.lowest && strain < *options.lowest) ||
               (options.highest && strain > *options.highest)) {
      ++outside;
    } else {
      kept.stretch.push_back(curve.stretch[i]);
      kept.stress.push_back(curve.stress[i]);
    }
  }
  if (after > 0) kept.note = std::to_string(after) + " points beyond the largest stress are left out";
  if (outside > 0)
    kept.note += (kept.note.empty() ? "" : ", ") + std::to_string(outside) + " outside the range of strain";
  curve = std::move(kept);
}

// "file.csv:equibiaxial" as file and mode.
Result<Mode> split_mode(std::string& path) {
  const auto colon = path.rfind(':');
  if (colon == std::string::npos || std::filesystem::exists(path)) return Mode::uniaxial;
  auto mode = mode_of(path.substr(colon + 1));
  if (!mode) return Error{path + ": after the colon: " + mode.error()};
  path.resize(colon);
  return mode;
}

// The points below the header.
Result<void> read_points(std::istream& in, const std::string& path, const Columns& c, std::size_t line_number,
                         Curve& curve) {
  for (std::string line; std::getline(in, line);) {
    ++line_number;
    if (trimmed(line).empty() || line.find_first_not_of(";,\t \r") == std::string::npos) continue;
    const std::vector<std::string> cells = cells_of(line, c.separator);
    const std::string where = path + ", line " + std::to_string(line_number) + ": ";
    if (cells.size() <= std::max(c.strain, c.stress))
      return Error{where + "fewer columns than the header has; complete or remove it"};
    const auto x = number_in(cells[c.strain], c.separator), y = number_in(cells[c.stress], c.separator);
    if (!x || !y)
      return Error{where + "\"" + cells[x ? c.stress : c.strain] +
                   "\" is no finite number; correct or remove the line"};
    append(c, c.strain_scale * *x, c.stress_scale * *y, curve);
    if (!(curve.stretch.back() > 0))
      return Error{where + "a stretch of " + std::to_string(curve.stretch.back()) +
                   "; stretches are positive, strains above -1 (say % in the header for percent)"};
  }
  return {};
}

}  // namespace

const char* word(Mode mode) {
  constexpr const char* words[] = {"uniaxial", "equibiaxial", "pure_shear"};
  return words[static_cast<int>(mode)];
}

Range range_of(const std::vector<Curve>& curves) {
  Range range;
  for (const Curve& curve : curves) {
    for (const double s : curve.stretch) range = {std::min(range.least, s), std::max(range.most, s)};
  }
  return range;
}

Result<Mode> mode_of(const std::string& said) {
  for (const Mode mode : {Mode::uniaxial, Mode::equibiaxial, Mode::pure_shear}) {
    if (said == word(mode)) return mode;
  }
  return Error{"\"" + said + "\" is no mode; write uniaxial, equibiaxial or pure_shear"};
}

Result<Curve> read_curve(const std::string& given, const CurveOptions& options) {
  std::string path = given;
  auto mode = split_mode(path);
  if (!mode) return mode.failure();
  std::ifstream in(path);
  if (!in) return Error{path + ": cannot be read; give a CSV file with columns of strain and stress"};
  return read_curve(in, path, mode.value(), options);
}

Result<Curve> read_curve(std::istream& in, const std::string& path, Mode mode, const CurveOptions& options) {
  std::optional<Columns> columns;
  std::size_t line_number = 0;
  for (std::string line; !columns && std::getline(in, line);) {
    ++line_number;
    columns = header_in(studies::without_mark(line), options);
  }
  if (!columns) {
    return Error{path + ": no line names a column of strain (or stretch) and one of stress" +
                 (options.strain_column.empty() && options.stress_column.empty()
                      ? "; name the columns in a header, or by --strain and --stress"
                      : " as --strain and --stress say; check their spelling")};
  }
  if (columns->stress_scale == 0) {
    return Error{path +
                 ": the unit of the stress is not in the name of its column; write it there, as in \"Stress "
                 "(kPa)\", or give --stress-unit Pa, kPa or MPa"};
  }
  Curve curve;
  curve.name = std::filesystem::path(path).stem().string();
  curve.mode = mode;
  if (auto r = read_points(in, path, *columns, line_number, curve); !r) return r.failure();
  if (curve.stress.empty()) return Error{path + ": the header has no points below it"};
  const double largest = std::max(std::abs(*std::max_element(curve.stress.begin(), curve.stress.end())),
                                  std::abs(*std::min_element(curve.stress.begin(), curve.stress.end())));
  if (largest < 10 || largest > 1e9) {
    std::ostringstream text;
    text << path << ": the largest stress is " << largest
         << " Pa, which no soft material has; check the unit (--stress-unit)";
    return Error{text.str()};
  }
  select(options, curve);
  const auto deformed = std::count_if(curve.stretch.begin(), curve.stretch.end(),
                                      [](double s) { return std::abs(s - 1) > 1e-9; });
  if (deformed < 3) {
    return Error{path + ": " + std::to_string(deformed) +
                 " points that are stretched or compressed are left" +
                 (curve.note.empty() ? "" : " (" + curve.note + ")") +
                 "; a fit takes three: give more, or say the range by --from and --to"};
  }
  return curve;
}

}  // namespace isochor::fit
