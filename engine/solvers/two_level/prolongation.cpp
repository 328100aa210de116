#include "engine/solvers/two_level/prolongation.h"

#include <algorithm>

namespace isochor {

void Prolongation::analyze(const SaddleMatrix& matrix, EdgeNodes edges,
                           std::span<const UnknownGeometry> geometry) {
  edges_ = std::move(edges);
  const Index nodes = matrix.nodes();
  rows_ = matrix.rows();
  unknown_at_.assign(3 * at(nodes), -1);
  direction_.clear();
  for (std::size_t u = 0; u < geometry.size(); ++u) {
    unknown_at_[at(matrix.place()[u])] = static_cast<Index>(u);
    direction_.push_back(geometry[u].direction);
  }
  corners_ = displacements_ = 0;
  corner_of_.assign(at(nodes), -1);
  coarse_unknown_.clear();
  for (Index i = 0; i < nodes; ++i) {
    if (edges_.ends[at(i)][0] >= 0) continue;
    corner_of_[at(i)] = corners_++;
    for (std::size_t q = 0; q < 3; ++q)
      coarse_unknown_.push_back(unknown_at_[3 * at(i) + q] >= 0 ? displacements_++ : -1);
  }
  std::vector<Part> by_node;
  for (Index i = 0; i < nodes; ++i) {
    if (!is_middle(i)) {
      by_node.push_back({i, corner_of_[at(i)]});
      continue;
    }
    for (const Index end : edges_.ends[at(i)]) by_node.push_back({i, corner_of_[at(end)]});
  }
  part_start_.assign(at(corners_) + 1, 0);
  for (const Part& p : by_node) ++part_start_[at(p.corner) + 1];
  for (std::size_t c = 0; c < at(corners_); ++c) part_start_[c + 1] += part_start_[c];
  part_.resize(by_node.size());
  parts_of_.assign(at(nodes), {-1, -1});
  auto next = part_start_;
  for (const Part& p : by_node) {
    const std::size_t k = next[at(p.corner)]++;
    part_[k] = p;
    auto& of = parts_of_[at(p.node)];
    of[of[0] < 0 ? 0 : 1] = static_cast<Index>(k);
  }
}

void Prolongation::weigh(std::span<const double> scale) {
  std::vector<Index> node_of(at(corners_));
  for (std::size_t i = 0; i < corner_of_.size(); ++i) {
    if (corner_of_[i] >= 0) node_of[at(corner_of_[i])] = static_cast<Index>(i);
  }
  const auto scale_of = [&](Index u) { return scale.empty() ? 1.0 : scale[at(u)]; };
  for (Part& p : part_) {
    if (!is_middle(p.node)) continue;
    const Index* const to = unknown_at_.data() + 3 * p.node;
    const Index* const from = unknown_at_.data() + 3 * node_of[at(p.corner)];
    double least = 1e300, most = 0, beside = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        double w = 0;
        if (to[i] >= 0 && from[j] >= 0)
          w = 0.5 * dot(direction_[at(to[i])], direction_[at(from[j])]) * scale_of(from[j]) / scale_of(to[i]);
        p.block[at(3 * i + j)] = w;
        if (i != j) beside = std::max(beside, std::abs(w));
        if (i == j) least = std::min(least, w), most = std::max(most, w);
      }
    }
    p.even = beside == 0 && least == most;
    p.factor = most;
  }
}

void Prolongation::restrict_to(const RowLoop& loop, std::span<const double> fine,
                               std::span<double> coarse) const {
  loop(corners_, 256, [&](Index begin, Index end) {
    for (Index c = begin; c < end; ++c) {
      double sum[3] = {};
      for (const Part& p : of_corner(c)) {
        const double* const f = fine.data() + 3 * static_cast<std::ptrdiff_t>(p.node);
        for (int j = 0; j < 3; ++j) {
          if (p.even) {
            sum[j] += p.factor * f[j];
          } else {
            for (int i = 0; i < 3; ++i) sum[j] += p.block[at(3 * i + j)] * f[i];
          }
        }
      }
      for (int j = 0; j < 3; ++j) {
        if (const Index u = coarse_unknown(c, j); u >= 0) coarse[at(u)] = sum[j];
      }
    }
  });
  const auto first = static_cast<std::ptrdiff_t>(3 * corner_of_.size());
  std::copy_n(fine.begin() + first, rows_, coarse.begin() + displacements_);
}

void Prolongation::prolong(const RowLoop& loop, std::span<const double> coarse,
                           std::span<double> fine) const {
  loop(static_cast<Index>(corner_of_.size()), 512, [&](Index begin, Index end) {
    for (Index node = begin; node < end; ++node) {
      double* const f = fine.data() + 3 * static_cast<std::ptrdiff_t>(node);
      for (const Index k : of_node(node)) {
        if (k < 0) continue;
        const Part& p = part_[at(k)];
        double e[3];
        for (int j = 0; j < 3; ++j) {
          const Index u = coarse_unknown(p.corner, j);
          e[j] = u >= 0 ? coarse[at(u)] : 0;
        }
        for (int i = 0; i < 3; ++i) {
          if (p.even) {
            f[i] += p.factor * e[i];
          } else {
            for (int j = 0; j < 3; ++j) f[i] += p.block[at(3 * i + j)] * e[j];
          }
        }
      }
    }
  });
  const std::size_t first = 3 * corner_of_.size();
  for (std::size_t r = 0; r < at(rows_); ++r) fine[first + r] += coarse[at(displacements_) + r];
}

}  // namespace isochor
