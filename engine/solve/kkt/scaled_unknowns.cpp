#include "engine/solve/kkt/scaled_unknowns.h"

#include <algorithm>
#include <cmath>

namespace isochor {

ScaledUnknowns::ScaledUnknowns(const System& system) : system_(system), scale_(at(system.kkt().size)) {}

void ScaledUnknowns::choose(const MatrixValues& values, std::span<double> matrix) {
  const NodeUnknowns& nodes = system_.unknowns();
  const auto& diagonal = system_.matrix().diagonal;
  const Shares* const shares = system_.shares();
  for (Index i = 0; i < system_.nodes(); ++i) {
    if (shares && !shares->owns(i)) continue;
    double k = 0;
    for (Index c = nodes.begin(i); c < nodes.end(i); ++c) {
      k = std::max(k, std::abs(matrix[static_cast<std::size_t>(diagonal[at(c)])]));
    }
    const double reference = std::max(k, 0.01 * values.stiffness[at(i)]);
    for (Index c = nodes.begin(i); c < nodes.end(i); ++c) {
      scale_[at(c)] = reference > 0 ? 1 / std::sqrt(reference) : 1;
      matrix[static_cast<std::size_t>(diagonal[at(c)])] += values.shift * reference;
    }
  }
  if (shares) shares->gather_unknowns(scale_);
  const TreatedRows& rows = system_.treated();
  for (const Index r : rows.kept)
    scale_[at(rows.unknown[at(r)])] = 1 / std::sqrt(system_.row_metric()[at(r)]);
}

void ScaledUnknowns::choose_again(std::span<const double> matrix) {
  for (Index c = 0; c < system_.free_unknowns(); ++c) {
    const std::int64_t place = system_.matrix().diagonal[at(c)];
    if (place < 0) continue;
    const double d = std::abs(matrix[static_cast<std::size_t>(place)]);
    scale_[at(c)] = std::min(scale_[at(c)], d > 0 ? 1 / std::sqrt(d) : 1);
  }
  if (system_.shares()) system_.shares()->gather_unknowns(scale_);
}

void ScaledUnknowns::apply(const Parallel& parallel, std::span<double> matrix) const {
  const SymmetricPattern& pattern = system_.kkt();
  parallel.run(pattern.size, 1024, [&](Index b, Index e) {
    for (Index c = b; c < e; ++c) {
      const auto to = static_cast<std::size_t>(pattern.column_start[at(c) + 1]);
      for (auto k = static_cast<std::size_t>(pattern.column_start[at(c)]); k < to; ++k) {
        matrix[k] *= scale_[at(c)] * scale_[at(pattern.row[k])];
      }
    }
  });
}

void ScaledUnknowns::from_nodes(std::span<const Vec3> force, std::span<double> u) const {
  const NodeUnknowns& nodes = system_.unknowns();
  for (Index i = 0; i < system_.nodes(); ++i) {
    const Vec3 q = nodes.to_free(i, force[at(i)]);
    const Index first = nodes.begin(i);
    for (Index c = first; c < nodes.end(i); ++c) u[at(c)] = scale_[at(c)] * q[c - first];
  }
}

void ScaledUnknowns::to_nodes(std::span<const double> u, std::span<Vec3> dx) const {
  const NodeUnknowns& nodes = system_.unknowns();
  for (Index i = 0; i < system_.nodes(); ++i) {
    Vec3 q{};
    const Index first = nodes.begin(i);
    for (Index c = first; c < nodes.end(i); ++c) q[c - first] = scale_[at(c)] * u[at(c)];
    dx[at(i)] = nodes.from_free(i, q);
  }
}

void ScaledUnknowns::add_forces(double factor, std::span<const Vec3> force, std::span<double> w) const {
  const NodeUnknowns& nodes = system_.unknowns();
  for (Index i = 0; i < system_.nodes(); ++i) {
    if (force[at(i)] == Vec3{}) continue;
    const Vec3 q = nodes.to_free(i, force[at(i)]);
    const Index first = nodes.begin(i);
    for (Index c = first; c < nodes.end(i); ++c) w[at(c)] += factor * scale_[at(c)] * q[c - first];
  }
}

}  // namespace isochor
