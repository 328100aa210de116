// Aligned columns on a terminal.
#pragma once

#include <string>
#include <vector>

namespace isochor::app {

class Table {
 public:
  explicit Table(std::vector<std::string> header) { rows_.push_back(std::move(header)); }
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  // Columns that hold numbers are flush right.
  void numbers_from(std::size_t first, std::size_t last) {
    first_number_ = first;
    last_number_ = last;
  }
  std::string text(const std::string& indent = "") const;

 private:
  std::vector<std::vector<std::string>> rows_;
  std::size_t first_number_ = 1, last_number_ = 0;
};

// `digits` significant digits, without trailing zeros.
std::string number(double value, int digits = 5);

// Seconds as "12.3s" or "4m05s".
std::string duration(double seconds);

}  // namespace isochor::app
