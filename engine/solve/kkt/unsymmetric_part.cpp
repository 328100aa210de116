#include "engine/solve/kkt/unsymmetric_part.h"

#include <algorithm>

namespace isochor {

namespace {

// B_i^T S B_j, B the free directions of nodes that have given ones.
Mat3 in_free_basis(const System& s, Index i, Index j, const Mat3& block) {
  const Index bi = s.basis_of()[at(i)], bj = s.basis_of()[at(j)];
  if (bi < 0 && bj < 0) return block;
  const auto basis = [&](Index b) {
    Mat3 identity;
    for (int k = 0; k < 3; ++k) identity(k, k) = 1;
    return b < 0 ? identity : s.free_bases()[at(b)].directions;
  };
  const Mat3 left = basis(bi), right = basis(bj);
  Mat3 out;
  for (int c = 0; c < 3; ++c) {
    const Vec3 column = transposed_times(left, block * Vec3{right(0, c), right(1, c), right(2, c)});
    for (int r = 0; r < 3; ++r) out(r, c) = column[r];
  }
  return out;
}

void add(Mat3& sum, const Mat3& m) {
  for (std::size_t k = 0; k < 9; ++k) sum.m[k] += m.m[k];
}

}  // namespace

UnsymmetricPart::UnsymmetricPart(std::shared_ptr<const System> system, const Parallel& parallel)
    : system_(std::move(system)), parallel_(parallel) {
  std::size_t blocks = 0, columns = 0;
  for (const auto& [p, lagged] : system_->facets().lagged) {
    const StencilPool& pool = *system_->parts().stencil_pools[at(p)];
    PoolSlots slots{p, blocks, columns, {0}};
    for (Index s = 0; s < pool.stencils(); ++s) {
      const auto n = static_cast<std::int64_t>(pool.nodes()[s].size());
      slots.block_offset.push_back(slots.block_offset.back() + n * n);
    }
    blocks += static_cast<std::size_t>(slots.block_offset.back());
    columns += pool.nodes().item.size() * static_cast<std::size_t>(pool.functions());
    pools_.push_back(std::move(slots));
  }
  block_.resize(blocks);
  column_.resize(columns);
  place_blocks();
  place_columns();
}

void UnsymmetricPart::place_blocks() {
  const auto& ends = system_->gathers().block_ends;
  std::vector<std::pair<std::array<Index, 2>, std::size_t>> destination;
  destination.reserve(ends.size());
  for (std::size_t d = 0; d < ends.size(); ++d) destination.emplace_back(ends[d], d);
  std::sort(destination.begin(), destination.end());
  const auto find = [&](Index i, Index j) {
    const std::pair key(std::array{i, j}, std::size_t{0});
    const auto found = std::lower_bound(destination.begin(), destination.end(), key);
    return found != destination.end() && found->first == key.first ? found->second : ends.size();
  };
  for (const PoolSlots& slots : pools_) {
    const StencilPool& pool = *system_->parts().stencil_pools[at(slots.pool)];
    for (Index s = 0; s < pool.stencils(); ++s) {
      const auto nodes = pool.nodes()[s];
      const std::size_t n = nodes.size();
      const std::size_t first = slots.first_block + static_cast<std::size_t>(slots.block_offset[at(s)]);
      for (std::size_t a = 0; a < n; ++a) {
        for (std::size_t b = 0; b < n; ++b) {
          // The lower triangle names the larger node first; a node that is there twice meets itself both
          // ways.
          if (nodes[a] < nodes[b]) continue;
          block_source_.push_back(
              {find(nodes[a], nodes[b]), first + a * n + b, first + b * n + a, nodes[a], nodes[b]});
        }
      }
    }
  }
  // By nodes: every rank adds up in this order, whichever blocks it has.
  const auto nodes_of = [](const BlockSource& b) { return std::array{b.row, b.col}; };
  std::stable_sort(block_source_.begin(), block_source_.end(),
                   [&](const BlockSource& a, const BlockSource& b) { return nodes_of(a) < nodes_of(b); });
  for (std::size_t k = 0; k < block_source_.size(); ++k) {
    if (k == 0 || nodes_of(block_source_[k]) != nodes_of(block_source_[k - 1])) block_run_.push_back(k);
  }
  block_run_.push_back(block_source_.size());
}

void UnsymmetricPart::place_columns() {
  // A slot of ours is where the pool has its Jacobian slot.
  const Gather& gather = system_->gathers().jacobian;
  for (std::size_t d = 0; d < system_->gathers().jacobian_ends.size(); ++d) {
    for (auto k = static_cast<std::size_t>(gather.offset[d]);
         k < static_cast<std::size_t>(gather.offset[d + 1]); ++k) {
      const std::int64_t source = gather.source[k];
      for (const PoolSlots& slots : pools_) {
        const StencilPool& pool = *system_->parts().stencil_pools[at(slots.pool)];
        const std::int64_t first = system_->pools().slots[at(slots.pool)].jacobian;
        const auto count = static_cast<std::int64_t>(pool.nodes().item.size()) * pool.functions();
        if (source < first || source >= first + count) continue;
        column_source_.push_back(
            {d, slots.first_column + static_cast<std::size_t>(source - first), gather.weight[k]});
      }
    }
  }
  for (std::size_t k = 0; k < column_source_.size(); ++k) {
    if (k == 0 || column_source_[k].end != column_source_[k - 1].end) column_run_.push_back(k);
  }
  column_run_.push_back(column_source_.size());
  for (const ColumnSource& source : column_source_)
    rows_.push_back(system_->gathers().jacobian_ends[source.end][0]);
  std::sort(rows_.begin(), rows_.end());
  rows_.erase(std::unique(rows_.begin(), rows_.end()), rows_.end());
}

void UnsymmetricPart::evaluate(const Assembly& assembly, std::span<const Vec3> x) {
  for (const PoolSlots& slots : pools_) {
    const StencilPool& pool = *system_->parts().stencil_pools[at(slots.pool)];
    const StencilRequest whole = assembly.request(slots.pool, Want::hessian, x);
    const LagSlots out{
        slots.block_offset,
        std::span(block_).subspan(slots.first_block, static_cast<std::size_t>(slots.block_offset.back())),
        std::span(column_).subspan(slots.first_column,
                                   pool.nodes().item.size() * static_cast<std::size_t>(pool.functions()))};
    parallel_.run(pool.stencils(), pool.grain(), [&](Index begin, Index end) {
      StencilRequest part = whole;
      part.begin = begin;
      part.end = end;
      const auto from = static_cast<std::size_t>(slots.block_offset[at(begin)]),
                 to = static_cast<std::size_t>(slots.block_offset[at(end)]);
      std::fill_n(out.block.begin() + static_cast<std::ptrdiff_t>(from), to - from, Mat3{});
      const auto& offset = pool.nodes().offset;
      const Index functions = pool.functions();
      std::fill_n(out.column.begin() + functions * offset[at(begin)],
                  functions * (offset[at(end)] - offset[at(begin)]), Vec3{});
      pool.facets().lagged->lag_derivatives(part, out);
    });
  }
}

bool UnsymmetricPart::vanishes() const {
  return std::all_of(column_.begin(), column_.end(), [](const Vec3& v) { return v == Vec3{}; }) &&
         std::all_of(block_.begin(), block_.end(), [](const Mat3& m) { return m.m == Mat3{}.m; });
}

Vec3 UnsymmetricPart::column_of(std::size_t first, std::size_t last) const {
  Vec3 sum{};
  for (std::size_t k = first; k < last; ++k)
    sum += column_source_[k].weight * column_[column_source_[k].slot];
  return sum;
}

void UnsymmetricPart::add_to(std::span<const double> scale, std::span<const std::uint8_t> held,
                             std::span<double> lower, std::span<double> upper) const {
  const System& s = *system_;
  const auto first = s.first_unknown();
  for (std::size_t run = 0; run + 1 < block_run_.size(); ++run) {
    const std::size_t d = block_source_[block_run_[run]].block;
    if (d == s.gathers().block_ends.size()) continue;  // another rank has it
    const auto [i, j] = s.gathers().block_ends[d];
    const Index ki = first[at(i) + 1] - first[at(i)], kj = first[at(j) + 1] - first[at(j)];
    if (ki == 0 || kj == 0) continue;
    Mat3 below, above;  // the block (i, j), and (j, i)
    for (std::size_t k = block_run_[run]; k < block_run_[run + 1]; ++k) {
      add(below, block_[block_source_[k].lower]);
      add(above, block_[block_source_[k].upper]);
    }
    below = in_free_basis(s, i, j, below);
    above = in_free_basis(s, j, i, above);
    for (Index c = 0; c < kj; ++c) {
      auto to = static_cast<std::size_t>(s.matrix().block[3 * d + at(c)]);
      for (Index r = i == j ? c : 0; r < ki; ++r, ++to) {
        const double weight = scale[at(first[at(i)] + r)] * scale[at(first[at(j)] + c)];
        lower[to] += weight * below(r, c);
        // The diagonal belongs to the lower triangle.
        if (i != j || r != c) upper[to] += weight * above(c, r);
      }
    }
  }
  for (std::size_t run = 0; run + 1 < column_run_.size(); ++run) {
    const std::size_t d = column_source_[column_run_[run]].end;
    const auto [row, node] = s.gathers().jacobian_ends[d];
    const Index u = s.row_unknown()[at(row)];
    if (u < 0 || (!held.empty() && held[at(row)])) continue;
    Vec3 sum = column_of(column_run_[run], column_run_[run + 1]);
    const Index b = s.basis_of()[at(node)];
    if (b >= 0) sum = transposed_times(s.free_bases()[at(b)].directions, sum);
    for (Index c = 0; c < first[at(node) + 1] - first[at(node)]; ++c) {
      const std::int64_t place = s.matrix().jacobian[3 * d + at(c)];
      if (place < 0) continue;
      upper[static_cast<std::size_t>(place)] += scale[at(u)] * scale[at(first[at(node)] + c)] * sum[c];
    }
  }
}

void UnsymmetricPart::add_times(std::span<const Vec3> dx, std::span<const double> dlambda,
                                std::span<Vec3> y) const {
  const System& s = *system_;
  for (const BlockSource& source : block_source_) {
    const Index i = source.row, j = source.col;
    y[at(i)] += block_[source.lower] * dx[at(j)];
    if (i != j) y[at(j)] += block_[source.upper] * dx[at(i)];
  }
  for (const ColumnSource& source : column_source_) {
    const auto [row, node] = s.gathers().jacobian_ends[source.end];
    y[at(node)] += (source.weight * dlambda[at(row)]) * column_[source.slot];
  }
}

}  // namespace isochor
