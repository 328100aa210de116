#include "engine/solve/kkt/kept_rows.h"

#include <algorithm>

namespace isochor {

void KeptRows::assemble(const MatrixValues& values, std::span<double> matrix) const {
  const System& s = system_;
  for (const auto& [index, entry] : s.laws()) {
    const std::size_t entries = s.parts().row_pools[at(index)]->compliance.size();
    for (std::size_t k = entry; k < entry + entries; ++k) {
      const auto place = s.matrix().compliance[k];
      if (place >= 0) matrix[static_cast<std::size_t>(place)] -= values.tangent[k];
    }
  }
  if (values.clamped.empty()) return;
  const SymmetricPattern& pattern = s.kkt();
  const auto held = [&](Index unknown) {
    const Index k = unknown - s.free_unknowns(), row = k >= 0 ? s.treated().kept[at(k)] : -1;
    return row >= 0 && values.clamped[at(row)] ? row : -1;
  };
  for (Index c = 0; c < pattern.size; ++c) {
    const auto to = static_cast<std::size_t>(pattern.column_start[at(c) + 1]);
    const bool column_held = held(c) >= 0;
    for (auto k = static_cast<std::size_t>(pattern.column_start[at(c)]); k < to; ++k) {
      const Index row = held(pattern.row[k]);
      if (row < 0 && !column_held) continue;
      matrix[k] = pattern.row[k] == c ? -s.row_metric()[at(row)] : 0;
    }
  }
}

void KeptRows::add_trace(double trace, std::span<double> matrix, std::span<double> work) const {
  const SymmetricPattern& pattern = system_.kkt();
  const Index first = system_.free_unknowns();
  std::fill(work.begin(), work.end(), 0.0);
  for (Index c = 0; c < first; ++c) {
    const auto to = static_cast<std::size_t>(pattern.column_start[at(c) + 1]);
    for (auto k = static_cast<std::size_t>(pattern.column_start[at(c)]); k < to; ++k) {
      if (pattern.row[k] >= first) work[at(pattern.row[k])] += matrix[k] * matrix[k];
    }
  }
  if (system_.shares()) system_.shares()->sum(work);
  for (Index u = first; u < pattern.size; ++u) {
    const std::int64_t place = system_.matrix().diagonal[at(u)];
    if (place >= 0) matrix[static_cast<std::size_t>(place)] -= trace * work[at(u)];
  }
}

void KeptRows::reduce(std::span<const double> row_rhs, std::span<const double> scale,
                      std::span<double> rhs) const {
  const TreatedRows& rows = system_.treated();
  for (const Index r : rows.kept) {
    const std::size_t u = at(rows.unknown[at(r)]);
    rhs[u] = scale[u] * row_rhs[at(r)];
  }
}

void KeptRows::recover(std::span<const double> solution, std::span<const double> scale,
                       std::span<double> dlambda) const {
  const TreatedRows& rows = system_.treated();
  for (const Index r : rows.kept) {
    const std::size_t u = at(rows.unknown[at(r)]);
    dlambda[at(r)] = scale[u] * solution[u];
  }
}

}  // namespace isochor
