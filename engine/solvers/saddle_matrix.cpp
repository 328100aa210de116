#include "engine/solvers/saddle_matrix.h"

#include <algorithm>

namespace isochor {
namespace {

using Pair = std::array<Index, 2>;

// Compresses pairs (row, column): sorted, each once.
void compress(std::vector<Pair>& pairs, Index rows, std::vector<std::int64_t>& start,
              std::vector<Index>& column) {
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  start.assign(at(rows) + 1, 0);
  column.clear();
  column.reserve(pairs.size());
  for (const auto& [r, c] : pairs) {
    ++start[at(r) + 1];
    column.push_back(c);
  }
  for (std::size_t r = 0; r < at(rows); ++r) start[r + 1] += start[r];
}

std::int64_t find(const std::vector<std::int64_t>& start, const std::vector<Index>& column, Index r,
                  Index c) {
  const auto begin = column.begin() + start[at(r)], end = column.begin() + start[at(r) + 1];
  return std::lower_bound(begin, end, c) - column.begin();
}

}  // namespace

void SaddleMatrix::number_nodes(const SymmetricPattern& pattern, std::span<const UnknownGeometry> geometry) {
  place_.assign(at(pattern.size), -1);
  const auto is_row = [&](Index u) {
    if (!pattern.multiplier.empty()) return pattern.multiplier[at(u)] != 0;
    return !geometry.empty() && at(u) >= geometry.size();
  };
  nodes_ = rows_ = 0;
  Index previous = -1, used = 3;
  for (Index u = 0; u < pattern.size; ++u) {
    if (is_row(u)) continue;
    const Index owner = at(u) < geometry.size() ? geometry[at(u)].node
                                                : (pattern.group.empty() ? u / 3 : pattern.group[at(u)]);
    if (used == 3 || owner != previous) {
      ++nodes_;
      used = 0;
    }
    previous = owner;
    place_[at(u)] = 3 * (nodes_ - 1) + used++;
  }
  for (Index u = 0; u < pattern.size; ++u) {
    if (place_[at(u)] < 0) place_[at(u)] = 3 * nodes_ + rows_++;
  }
}

void SaddleMatrix::analyze(const SymmetricPattern& pattern, std::span<const UnknownGeometry> geometry) {
  number_nodes(pattern, geometry);
  const Index displacements = 3 * nodes_;
  std::vector<Pair> nodes, gradients, by_node, compliances;
  for (Index i = 0; i < nodes_; ++i) nodes.push_back({i, i});
  for (Index r = 0; r < rows_; ++r) compliances.push_back({r, r});
  const auto for_entries = [&](const auto& visit) {
    for (Index c = 0; c < pattern.size; ++c) {
      for (auto k = pattern.column_start[at(c)]; k < pattern.column_start[at(c) + 1]; ++k) {
        visit(static_cast<std::size_t>(k), place_[at(pattern.row[static_cast<std::size_t>(k)])],
              place_[at(c)]);
      }
    }
  };
  const auto add = [](std::vector<Pair>& to, Pair p) {
    if (to.empty() || to.back() != p) to.push_back(p);
  };
  for_entries([&](std::size_t, Index i, Index j) {
    if (i < displacements && j < displacements) {
      add(nodes, {i / 3, j / 3});
      if (i / 3 != j / 3) nodes.push_back({j / 3, i / 3});
    } else if (i < displacements || j < displacements) {
      add(gradients, {std::max(i, j) - displacements, std::min(i, j) / 3});
    } else {
      compliances.push_back({i - displacements, j - displacements});
      compliances.push_back({j - displacements, i - displacements});
    }
  });
  BlockMatrix& k = stiffness_pattern_;
  k = {};
  k.rows = k.columns = nodes_;
  compress(nodes, nodes_, k.start, k.column);
  nodes = {};
  compress(gradients, rows_, row_start_, row_node_);
  for (const auto& [r, i] : gradients) by_node.push_back({i, r});
  compress(by_node, nodes_, node_start_, node_row_);
  compress(compliances, rows_, compliance_start_, compliance_column_);
  node_block_.clear();
  for (Index i = 0; i < nodes_; ++i) {
    for (auto e = node_start_[at(i)]; e < node_start_[at(i) + 1]; ++e) {
      node_block_.push_back(find(row_start_, row_node_, node_row_[static_cast<std::size_t>(e)], i));
    }
  }
  gradient_.assign(3 * row_node_.size(), 0);
  compliance_.assign(compliance_column_.size(), 0);
  row_diagonal_.assign(at(rows_), 0);
  compliance_diagonal_.clear();
  for (Index r = 0; r < rows_; ++r) {
    compliance_diagonal_.push_back(find(compliance_start_, compliance_column_, r, r));
  }
  const auto entries = static_cast<std::size_t>(pattern.nonzeros());
  slot_.assign(entries, -1);
  mirror_.assign(entries, -1);
  part_.assign(entries, 0);
  for_entries([&](std::size_t e, Index i, Index j) {
    if (i < displacements && j < displacements) {
      slot_[e] = 9 * k.find(i / 3, j / 3) + 3 * (i % 3) + j % 3;
      if (i != j) mirror_[e] = 9 * k.find(j / 3, i / 3) + 3 * (j % 3) + i % 3;
    } else if (i < displacements || j < displacements) {
      const Index u = std::min(i, j);
      part_[e] = 1;
      slot_[e] = 3 * find(row_start_, row_node_, std::max(i, j) - displacements, u / 3) + u % 3;
    } else {
      part_[e] = 2;
      slot_[e] = find(compliance_start_, compliance_column_, i - displacements, j - displacements);
      if (i != j)
        mirror_[e] = find(compliance_start_, compliance_column_, j - displacements, i - displacements);
    }
  });
}

void SaddleMatrix::set_values(std::span<const double> values, BlockMatrix& stiffness) {
  std::fill(stiffness.value.begin(), stiffness.value.end(), 0.0);
  double* const parts[] = {stiffness.value.data(), gradient_.data(), compliance_.data()};
  for (std::size_t e = 0; e < values.size(); ++e) {
    double* const to = parts[part_[e]];
    to[slot_[e]] = values[e];
    if (mirror_[e] >= 0) to[mirror_[e]] = values[e];
  }
  for (std::size_t r = 0; r < row_diagonal_.size(); ++r) {
    row_diagonal_[r] = -compliance_[static_cast<std::size_t>(compliance_diagonal_[r])];
  }
}

void SaddleMatrix::add_row_forces(const RowLoop& loop, double factor, std::span<const double> multipliers,
                                  std::span<double> displacements) const {
  loop(nodes_, 512, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      double sum[3] = {};
      for (auto e = node_start_[at(i)]; e < node_start_[at(i) + 1]; ++e) {
        const double l = multipliers[at(node_row_[static_cast<std::size_t>(e)])];
        const double* const g = gradient_.data() + 3 * node_block_[static_cast<std::size_t>(e)];
        for (int q = 0; q < 3; ++q) sum[q] += g[q] * l;
      }
      for (std::size_t q = 0; q < 3; ++q) displacements[3 * at(i) + q] += factor * sum[q];
    }
  });
}

void SaddleMatrix::multiply(const RowLoop& loop, const BlockMatrix& stiffness, std::span<const double> x,
                            std::span<double> y) const {
  const std::size_t displacements = 3 * at(nodes_);
  isochor::multiply(loop, stiffness, x.first(displacements), y.first(displacements));
  const auto multiplier = x.subspan(displacements);
  add_row_forces(loop, 1, multiplier, y.first(displacements));
  loop(rows_, 256, [&](Index begin, Index end) {
    for (Index r = begin; r < end; ++r) {
      double sum = 0;
      for (auto e = row_start_[at(r)]; e < row_start_[at(r) + 1]; ++e) {
        const double* const g = gradient_.data() + 3 * e;
        const double* const xi = x.data() + 3 * at(row_node_[static_cast<std::size_t>(e)]);
        sum += g[0] * xi[0] + g[1] * xi[1] + g[2] * xi[2];
      }
      for (auto e = compliance_start_[at(r)]; e < compliance_start_[at(r) + 1]; ++e) {
        const auto place = static_cast<std::size_t>(e);
        sum += compliance_[place] * multiplier[at(compliance_column_[place])];
      }
      y[displacements + at(r)] = sum;
    }
  });
}

void SaddleMatrix::row_gradient(Index row, std::span<double> displacements) const {
  std::fill(displacements.begin(), displacements.end(), 0.0);
  for (auto e = static_cast<std::size_t>(row_start_[at(row)]);
       e < static_cast<std::size_t>(row_start_[at(row) + 1]); ++e) {
    std::copy_n(gradient_.data() + 3 * e, 3, displacements.data() + 3 * at(row_node_[e]));
  }
}

std::size_t SaddleMatrix::bytes() const {
  return (slot_.size() + mirror_.size()) * sizeof(std::int64_t) + part_.size() +
         (gradient_.size() + compliance_.size()) * sizeof(double) +
         (node_block_.size() + row_node_.size() + node_row_.size() + compliance_column_.size()) *
             sizeof(std::int64_t);
}

}  // namespace isochor
