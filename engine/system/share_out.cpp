#include "engine/system/share_out.h"

#include <algorithm>
#include <numeric>

#include "engine/solvers/partition.h"

namespace isochor {

namespace {

constexpr std::size_t widest = 64;  // stencils over more nodes do not hold a mesh together

std::size_t slot_bytes(const StencilPool& pool) {
  const std::size_t blocks = pool.has_hessian() ? static_cast<std::size_t>(pool.hessian_offset().back()) : 0;
  return pool.nodes().item.size() * (2 + at(pool.functions())) * sizeof(Vec3) + blocks * sizeof(Mat3);
}

// Whether stencils of the pool are evaluated where their nodes are, not everywhere.
bool is_split(const SystemParts& parts, const StencilPool& pool) {
  constexpr std::size_t small_share = 20;  // one part in so many of all slots
  const StencilFacets f = pool.facets();
  if (f.lagged || f.barrier || f.renewed) return false;
  std::size_t all = 0;
  for (const auto& p : parts.stencil_pools) all += slot_bytes(*p);
  if (small_share * slot_bytes(pool) < all) return false;
  return std::none_of(parts.row_pools.begin(), parts.row_pools.end(), [&](const auto& rows) {
    return parts.stencil_pools[at(rows->stencil_pool)].get() == &pool &&
           (!rows->lower.empty() || !rows->upper.empty());
  });
}

std::vector<Index> cut(const SystemParts& parts, Index ranks) {
  std::vector<Index> weight(parts.rest.size(), 1);
  Lists together;
  for (const auto& pool : parts.stencil_pools) {
    if (!is_split(parts, *pool)) continue;
    for (Index s = 0; s < pool->stencils(); ++s) {
      const auto nodes = pool->nodes()[s];
      for (const Index i : nodes) weight[at(i)] += static_cast<Index>(nodes.size());
      if (nodes.size() > 1 && nodes.size() <= widest) together.push(nodes);
    }
  }
  return partition_nodes(together.offset, together.item, weight, ranks);
}

// Rows over stencils of a pool that is split, one flag a row pool.
std::vector<bool> over_split_pools(const SystemParts& parts) {
  std::vector<bool> split;
  for (const auto& rows : parts.row_pools)
    split.push_back(is_split(parts, *parts.stencil_pools[at(rows->stencil_pool)]));
  return split;
}

// The owner of the first node of each row that has an unknown.
std::vector<Index> owners_of_rows(const System& system, const SystemTables& t) {
  std::vector<Index> owner(at(system.rows()), 0);
  for (Index r = 0; r < system.rows(); ++r) {
    const std::size_t begin = t.gathers.row_begin[at(r)], end = t.gathers.row_begin[at(r) + 1];
    if (begin == end) continue;
    std::size_t d = begin;
    while (d < end && t.unknowns.of(t.gathers.jacobian_ends[d][1]) == 0) ++d;
    owner[at(r)] = t.shares->owner(t.gathers.jacobian_ends[d < end ? d : begin][1]);
  }
  return owner;
}

}  // namespace

std::unique_ptr<Shares> share_nodes(const SystemParts& parts) {
  const Ranks& ranks = *parts.ranks;
  std::vector<double> part(parts.rest.size(), 0);
  // One rank cuts, so that all have the same parts whatever their libraries.
  if (ranks.size() > 1) {
    if (ranks.rank() == 0) {
      const std::vector<Index> own = cut(parts, static_cast<Index>(ranks.size()));
      std::copy(own.begin(), own.end(), part.begin());
    }
    ranks.sum(part);
  }
  std::vector<Index> owner(part.size());
  std::transform(part.begin(), part.end(), owner.begin(), [](double r) { return static_cast<Index>(r); });
  return std::make_unique<Shares>(parts.ranks, std::move(owner));
}

std::vector<StencilRun> shared_runs(const SystemParts& parts, const StencilPool& pool, const Shares& shares) {
  const bool split = is_split(parts, pool);
  std::vector<StencilRun> runs;
  Index owner = -1;  // of the last run
  for (Index s = 0; s < pool.stencils(); ++s) {
    const auto nodes = pool.nodes()[s];
    const bool touches = std::any_of(nodes.begin(), nodes.end(), [&](Index i) { return shares.owns(i); });
    if (split && !touches) continue;
    // Runs end where owners change, whoever asks: pools take stencils of a run together, and what all ranks
    // evaluate has the same bits on all of them only where they take the same ones.
    const Index now = nodes.empty() ? 0 : shares.owner(nodes[0]);
    if (runs.empty() || runs.back().end != s || now != owner) runs.push_back({s, s, now == shares.rank()});
    owner = now;
    runs.back().end = s + 1;
  }
  return runs;
}

void find_row_begins(Gathers& gathers, Index rows) {
  auto& begin = gathers.row_begin;
  begin.assign(at(rows) + 1, 0);
  for (const auto& [row, node] : gathers.jacobian_ends) ++begin[at(row) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
}

Result<void> share_rows(const System& system, SystemTables& t) {
  Shares& shares = *t.shares;
  if (!t.treated.dual.empty()) {
    return Error{
        "world: rows with treatment dual or augmented are not shared out over ranks yet; use another "
        "treatment, or run on one process"};
  }
  const std::vector<bool> split = over_split_pools(system.parts());
  std::vector<bool> bordered(at(system.rows()), false);
  for (const Index r : t.treated.bordered) bordered[at(r)] = true;
  shares.share_unknowns(t.unknowns.first);
  shares.share_rows(owners_of_rows(system, t));
  // Of wide rows that go around the matrix every rank needs the whole vector, to which each adds its nodes.
  std::vector<bool> summed(at(system.rows()), false);
  for (std::size_t p = 0; p < split.size(); ++p) {
    const RowPool& rows = *system.parts().row_pools[p];
    if (!split[p] || rows.law != RowLaw::compliant) continue;
    const Index first = system.first_row(static_cast<Index>(p));
    for (Index r = first; r < first + rows.rows(); ++r) {
      if (!bordered[at(r)]) continue;
      summed[at(r)] = true;
      shares.summed_rows.push_back(r);
    }
  }
  const Gather all = std::move(t.gathers.jacobian);
  const auto ends = std::move(t.gathers.jacobian_ends);
  t.gathers.jacobian = {};
  t.gathers.jacobian_ends.clear();
  for (std::size_t d = 0; d < ends.size(); ++d) {
    const auto [row, node] = ends[d];
    const auto from = static_cast<std::size_t>(all.offset[d]),
               to = static_cast<std::size_t>(all.offset[d + 1]);
    const bool here = std::all_of(all.source.begin() + static_cast<std::ptrdiff_t>(from),
                                  all.source.begin() + static_cast<std::ptrdiff_t>(to),
                                  [](std::int64_t source) { return source >= 0; });
    if (!here && !summed[at(row)]) continue;
    for (std::size_t k = from; k < to && (!summed[at(row)] || shares.owns(node)); ++k) {
      t.gathers.jacobian.source.push_back(all.source[k]);
      t.gathers.jacobian.weight.push_back(all.weight[k]);
    }
    t.gathers.jacobian.offset.push_back(static_cast<std::int64_t>(t.gathers.jacobian.source.size()));
    t.gathers.jacobian_ends.push_back(ends[d]);
  }
  find_row_begins(t.gathers, system.rows());
  auto& owner = t.matrix.pattern.owner;
  owner.resize(at(system.free_unknowns()) + t.treated.kept.size());
  for (Index i = 0; i < system.nodes(); ++i)
    std::fill(owner.begin() + t.unknowns.begin(i), owner.begin() + t.unknowns.end(i), shares.owner(i));
  for (const Index r : t.treated.kept) owner[at(t.treated.unknown[at(r)])] = shares.row_owner(r);
  return {};
}

}  // namespace isochor
