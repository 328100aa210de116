#include "engine/solvers/pattern_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/base.h"

namespace isochor {

std::string check(const SymmetricPattern& p) {
  const auto n = p.size;
  if (n < 0) return "the pattern has a negative size";
  if (n == 0) return {};
  if (p.column_start.size() != at(n) + 1 || p.column_start.front() != 0 ||
      p.row.size() != static_cast<std::size_t>(p.nonzeros())) {
    return "the pattern's arrays do not fit its size";
  }
  for (Index c = 0; c < n; ++c) {
    Index previous = c - 1;
    if (p.column_start[at(c)] > p.column_start[at(c) + 1]) return "the pattern's columns are not in sequence";
    for (auto k = p.column_start[at(c)]; k < p.column_start[at(c) + 1]; ++k) {
      const Index r = p.row[static_cast<std::size_t>(k)];
      if (r <= previous || r >= n) {
        return "column " + std::to_string(c) +
               " of the pattern must hold ascending rows of the lower triangle";
      }
      previous = r;
    }
  }
  if (!p.group.empty()) {
    if (p.group.size() != at(n)) return "the pattern's groups do not fit its size";
    for (const Index g : p.group) {
      if (g < 0 || g >= p.groups)
        return "the pattern names group " + std::to_string(g) + ", which is out of range";
    }
  }
  if (!p.multiplier.empty() && p.multiplier.size() != at(n))
    return "the pattern's multipliers do not fit its size";
  return {};
}

double matrix_norm(const SymmetricPattern& pattern, std::span<const double> values,
                   std::span<double> row_sum) {
  const double* const v = values.data();
  const bool two_triangles = values.size() > static_cast<std::size_t>(pattern.nonzeros());
  const double* const upper = two_triangles ? v + pattern.nonzeros() : v;
  std::fill(row_sum.begin(), row_sum.end(), 0.0);
  // One NaN or infinity makes the sum of zeros NaN.
  double poison = 0;
  for (Index c = 0; c < pattern.size; ++c) {
    double column = 0;
    for (auto k = pattern.column_start[at(c)]; k < pattern.column_start[at(c) + 1]; ++k) {
      const Index r = pattern.row[static_cast<std::size_t>(k)];
      const double a = std::abs(v[k]);
      poison += v[k] * 0.0 + upper[k] * 0.0;
      row_sum[at(r)] += a;
      if (r != c) column += std::abs(upper[k]);
    }
    row_sum[at(c)] += column;
  }
  if (poison != 0 || std::isnan(poison)) return std::numeric_limits<double>::quiet_NaN();
  return row_sum.empty() ? 0 : *std::max_element(row_sum.begin(), row_sum.end());
}

}  // namespace isochor
