// Rows of tables in text files, as spreadsheets and testing machines write them.
#pragma once

#include <sstream>
#include <string>
#include <vector>

namespace isochor::studies {

// Without blanks and quotes around it.
inline std::string trimmed(const std::string& text) {
  constexpr const char* around = " \t\r\"";
  const auto first = text.find_first_not_of(around);
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(around) - first + 1);
}

// The first line of a file may begin with a mark of its encoding (UTF-8), as spreadsheets put it there.
inline std::string without_mark(const std::string& line) {
  constexpr const char* mark = "\xEF\xBB\xBF";
  return line.starts_with(mark) ? line.substr(3) : line;
}

inline std::vector<std::string> cells_of(const std::string& line, char separator = ',') {
  std::vector<std::string> cells;
  std::stringstream stream(line);
  for (std::string cell; std::getline(stream, cell, separator);) cells.push_back(trimmed(cell));
  return cells;
}

}  // namespace isochor::studies
