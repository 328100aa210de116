// Jacobian vectors of rows that are not, or not only, unknowns of the matrix: G_r over scaled unknowns.
#pragma once

#include "engine/system/assembly.h"

namespace isochor {

class RowJacobian {
 public:
  // `scale` as ScaledUnknowns::scale(), alive as long as this.
  RowJacobian(const System& system, std::span<const double> scale);
  RowJacobian(const RowJacobian&) = delete;
  RowJacobian& operator=(const RowJacobian&) = delete;

  // Needed before the rest; without it assemble() does nothing.
  void take_memory() { vector_.resize(system_.gathers().jacobian_ends.size()); }
  // From the last evaluation (Want::gradient or more).
  void assemble(const Assembly& assembly) {
    if (!vector_.empty()) assembly.row_jacobian(vector_);
  }

  // G_r u.
  double dot(Index row, std::span<const double> u) const {
    double sum = 0;
    for_entries(row, [&](std::size_t c, double g) { sum += scale_[c] * g * u[c]; });
    return sum;
  }
  // w += G_r^T multiplier.
  void add_force(Index row, double multiplier, std::span<double> w) const {
    for_entries(row, [&](std::size_t c, double g) { w[c] += scale_[c] * g * multiplier; });
  }
  // G_r^T among zeros.
  void column(Index row, std::span<double> column) const;

  // matrix += G_r^T weight G_r, unscaled, at the places of FilledRows from `place` on; returns where the next
  // row's begin.
  std::size_t add_square(Index row, double weight, std::span<const std::int64_t> places, std::size_t place,
                         std::span<double> matrix) const;

 private:
  template <class Body>
  void for_entries(Index row, const Body& body) const {
    const NodeUnknowns& nodes = system_.unknowns();
    const Gathers& gathers = system_.gathers();
    for (auto d = gathers.row_begin[at(row)]; d < gathers.row_begin[at(row) + 1]; ++d) {
      const Index i = gathers.jacobian_ends[d][1], first = nodes.begin(i);
      for (Index c = first; c < nodes.end(i); ++c) body(at(c), vector_[d][c - first]);
    }
  }

  const System& system_;
  std::span<const double> scale_;
  std::vector<Vec3> vector_;  // one for each of Gathers::jacobian_ends, in free directions
};

}  // namespace isochor
