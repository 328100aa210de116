#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "engine/solvers/front/front_tree.h"
#include "engine/solvers/ordering.h"
#include "engine/system/row_treatment.h"
#include "engine/system/share_out.h"
#include "engine/system/structure.h"

namespace isochor {

namespace {

// One contribution to a destination that is named by two indices.
struct Contribution {
  std::uint64_t key = 0;  // (first << 32) | second
  std::int64_t source = 0;
  double weight = 1;
};

std::uint64_t key_of(Index first, Index second) {
  return (static_cast<std::uint64_t>(first) << 32) | static_cast<std::uint32_t>(second);
}

std::uint64_t destination(const Contribution& c) {
  return c.key;
}
std::uint64_t destination(std::uint64_t key) {
  return key;
}

// By destination, in linear time and stable: contributions to one stay as they came, and this order is what
// makes sums independent of the thread count.
template <class T>
void sort_by_destination(std::vector<T>& items) {
  std::array<std::uint64_t, 2> largest{};
  for (const T& item : items) {
    largest[0] = std::max(largest[0], destination(item) & 0xffffffffu);
    largest[1] = std::max(largest[1], destination(item) >> 32);
  }
  std::vector<T> sorted(items.size());
  for (const int half : {0, 1}) {
    if (largest[static_cast<std::size_t>(half)] == 0) continue;
    const auto bucket = [half](const T& item) { return (destination(item) >> (32 * half)) & 0xffffffffu; };
    std::vector<std::size_t> next(largest[static_cast<std::size_t>(half)] + 2, 0);
    for (const T& item : items) ++next[bucket(item) + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    for (const T& item : items) sorted[next[bucket(item)]++] = item;
    items.swap(sorted);
  }
}

void gather_by_key(std::vector<Contribution>& c, bool weighted, Gather& gather,
                   std::vector<std::array<Index, 2>>& ends) {
  sort_by_destination(c);
  gather.source.reserve(c.size());
  if (weighted) gather.weight.reserve(c.size());
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (i == 0 || c[i].key != c[i - 1].key) {
      if (i != 0) gather.offset.push_back(static_cast<std::int64_t>(i));
      ends.push_back({static_cast<Index>(c[i].key >> 32), static_cast<Index>(c[i].key & 0xffffffffu)});
    }
    gather.source.push_back(c[i].source);
    if (weighted) gather.weight.push_back(c[i].weight);
  }
  if (!c.empty()) gather.offset.push_back(static_cast<std::int64_t>(c.size()));
}

}  // namespace

class SystemCompiler {
 public:
  explicit SystemCompiler(SystemParts parts)
      : s_(std::make_shared<System>()), t_(std::make_shared<SystemTables>()) {
    s_->parts_ = std::move(parts);
    s_->facets_ = SystemFacets(s_->parts_.stencil_pools, s_->parts_.row_pools);
    s_->tables_ = t_;
  }

  // With the tables of a system of the same structure; false: its structure is another.
  bool take_tables(const System& like) {
    if (s_->parts_.ranks || like.shares()) return false;
    if (!same_structure(s_->parts_, like.parts_) || s_->facets_.coupled != like.facets_.coupled) return false;
    s_->tables_ = like.tables_;
    // Numbers have a say in how rows are treated.
    TreatedRows treated;
    number_rows();
    collect_compliance();
    collect_bounds();
    if (!RowTreatments(*s_, treated).sort() || !same_treatment(treated, like.treated())) {
      s_->row_data_ = {};
      s_->tables_ = t_;
      return false;
    }
    if (like.parts_.ordering_base) s_->parts_.ordering_base = like.parts_.ordering_base;
    measure();
    place_mass();
    return true;
  }
  std::shared_ptr<System> system() const { return s_; }

  Result<std::shared_ptr<System>> run() {
    measure();
    if (s_->parts_.ranks) t_->shares = share_nodes(s_->parts_);
    place_pools();
    number_rows();
    if (auto r = number_unknowns(); !r) return r.failure();
    gather_rows();
    gather_residual();
    gather_blocks();
    place_mass();
    gather_jacobian();
    collect_compliance();
    collect_bounds();
    if (auto r = RowTreatments(*s_, t_->treated).sort(); !r) return r.failure();
    if (shares()) {
      if (auto r = share_rows(*s_, *t_); !r) return r.failure();
    }
    build_kkt();
    locate_entries();
    if (!shares()) group_unknowns();
    find_ordering_base();
    hash_layout();
    return s_;
  }

 private:
  const Shares* shares() const { return t_->shares.get(); }
  // Without ranks this one has everything.
  bool owns(Index node) const { return !shares() || shares()->owns(node); }
  bool owns_row(Index row) const { return !shares() || shares()->owns_row(row); }

  void measure() {
    Vec3 lo{}, hi{};
    bool first = true;
    for (const Vec3& x : s_->parts_.rest) {
      for (int i = 0; i < 3; ++i) {
        lo[i] = first ? x[i] : std::min(lo[i], x[i]);
        hi[i] = first ? x[i] : std::max(hi[i], x[i]);
      }
      first = false;
    }
    const Vec3 d = hi - lo;
    s_->length_ = std::sqrt(dot(d, d));
  }

  void place_pools() {
    PoolPlace at_place;
    for (const auto& pool : s_->parts_.stencil_pools) {
      t_->pools.slots.push_back(at_place);
      t_->pools.runs.push_back(shares() ? shared_runs(s_->parts_, *pool, *shares())
                                        : std::vector<StencilRun>{{0, pool->stencils()}});
      at_place.energy += pool->stencils();
      at_place.function += static_cast<std::int64_t>(pool->stencils()) * pool->functions();
      for (StencilRun& run : t_->pools.runs.back()) {
        const std::int64_t from = pool->nodes().offset[at(run.begin)], to = pool->nodes().offset[at(run.end)];
        run.gradient = at_place.gradient - from;
        run.jacobian = at_place.jacobian - from * pool->functions();
        at_place.gradient += to - from;
        at_place.jacobian += (to - from) * pool->functions();
        if (!pool->has_hessian()) continue;
        const std::int64_t first = pool->hessian_offset()[at(run.begin)];
        run.hessian = at_place.hessian - first;
        at_place.hessian += pool->hessian_offset()[at(run.end)] - first;
      }
    }
    t_->pools.total = at_place;
  }

  void number_rows() {
    for (const auto& pool : s_->parts_.row_pools) {
      Index& count = pool->law == RowLaw::compliant ? s_->row_data_.compliant : s_->row_data_.prescribed;
      s_->row_data_.first.push_back(count);
      count += pool->rows();
      if (pool->law == RowLaw::compliant) {
        s_->row_data_.metric.insert(s_->row_data_.metric.end(), pool->metric.begin(), pool->metric.end());
        s_->row_data_.measure.insert(s_->row_data_.measure.end(), pool->measure.begin(), pool->measure.end());
      }
    }
  }

  Result<void> number_unknowns() {
    const Index n = s_->nodes();
    t_->unknowns.basis_of.assign(at(n), -1);
    for (const auto& p : s_->parts_.prescribers) {
      for (const PrescribedNode& c : p->nodes) {
        if (t_->unknowns.basis_of[at(c.node)] >= 0) {
          return Error{std::string(p->name()) + ": node " + std::to_string(c.node) +
                       " is given by two prescribers of one scene; merge them first"};
        }
        t_->unknowns.basis_of[at(c.node)] = static_cast<Index>(t_->unknowns.bases.size());
        t_->unknowns.bases.push_back(free_basis(c));
      }
    }
    t_->unknowns.first.assign(1, 0);
    for (Index i = 0; i < n; ++i) {
      const Index b = t_->unknowns.basis_of[at(i)];
      t_->unknowns.first.push_back(t_->unknowns.first.back() + (b < 0 ? 3 : t_->unknowns.bases[at(b)].count));
    }
    return {};
  }

  // Completes the given directions to an orthonormal frame; axis-aligned ones stay exactly axis-aligned.
  static FreeBasis free_basis(const PrescribedNode& c) {
    std::array<Vec3, 3> frame{};
    int given = c.directions;
    for (int k = 0; k < given; ++k)
      frame[static_cast<std::size_t>(k)] = c.direction[static_cast<std::size_t>(k)];
    int found = given;
    while (found < 3) {
      Vec3 best{};
      double best_norm = -1;
      for (int axis = 0; axis < 3; ++axis) {
        Vec3 e{};
        e[axis] = 1;
        for (int k = 0; k < found; ++k) {
          const Vec3& f = frame[static_cast<std::size_t>(k)];
          e -= dot(e, f) * f;
        }
        const double norm = std::sqrt(dot(e, e));
        if (norm > best_norm + 1e-9) {
          best_norm = norm;
          best = (1 / norm) * e;
        }
      }
      frame[static_cast<std::size_t>(found++)] = best;
    }
    FreeBasis basis;
    basis.count = 3 - given;
    for (int k = 0; k < 3; ++k) {
      const Vec3& f = frame[static_cast<std::size_t>(k < basis.count ? given + k : k - basis.count)];
      for (int i = 0; i < 3; ++i) basis.directions(i, k) = f[i];
    }
    return basis;
  }

  // Number of a row in the gather lists: compliant rows first, then prescribed ones.
  Index gather_row(std::size_t pool, Index row) const {
    const Index base = s_->parts_.row_pools[pool]->law == RowLaw::compliant ? 0 : s_->row_data_.compliant;
    return base + s_->row_data_.first[pool] + row;
  }

  // Of a function of the pool that `rows` are over: this rank adds it to rows.
  bool answers_for(const RowPool& rows, Index function) const {
    const Index functions = s_->parts_.stencil_pools[at(rows.stencil_pool)]->functions();
    const StencilRun* run = t_->pools.run_of(rows.stencil_pool, function / functions);
    return run && run->own;
  }

  void gather_rows() {
    std::vector<Contribution> to_row, to_function;
    for (std::size_t p = 0; p < s_->parts_.row_pools.size(); ++p) {
      const RowPool& pool = *s_->parts_.row_pools[p];
      const std::int64_t base = t_->pools.slots[at(pool.stencil_pool)].function;
      for (Index r = 0; r < pool.rows(); ++r) {
        for (Index k = pool.map.offset[at(r)]; k < pool.map.offset[at(r) + 1]; ++k) {
          const std::int64_t f = base + pool.map.item[at(k)];
          const Index g = gather_row(p, r);
          if (!shares() || answers_for(pool, pool.map.item[at(k)]))
            to_row.push_back({static_cast<std::uint64_t>(g), f, pool.weight[at(k)]});
          to_function.push_back({static_cast<std::uint64_t>(f), g, pool.weight[at(k)]});
        }
      }
    }
    fill_gather(to_row, s_->row_data_.compliant + s_->row_data_.prescribed, t_->gathers.row);
    fill_gather(to_function, t_->pools.total.function, t_->gathers.function);
  }

  // Gather lists for destinations 0..count-1, the key being the destination.
  static void fill_gather(std::vector<Contribution>& c, std::int64_t count, Gather& gather) {
    sort_by_destination(c);
    std::size_t i = 0;
    for (std::int64_t d = 0; d < count; ++d) {
      for (; i < c.size() && c[i].key == static_cast<std::uint64_t>(d); ++i) {
        gather.source.push_back(c[i].source);
        gather.weight.push_back(c[i].weight);
      }
      gather.offset.push_back(static_cast<std::int64_t>(i));
    }
  }

  void gather_residual() {
    std::vector<Contribution> c;
    for (std::size_t p = 0; p < s_->parts_.stencil_pools.size(); ++p) {
      const Lists& nodes = s_->parts_.stencil_pools[p]->nodes();
      for (const StencilRun& run : t_->pools.runs[p]) {
        for (Index k = nodes.offset[at(run.begin)]; k < nodes.offset[at(run.end)]; ++k) {
          const Index node = nodes.item[at(k)];
          if (owns(node)) c.push_back({static_cast<std::uint64_t>(node), run.gradient + k, 1});
        }
      }
    }
    fill_gather(c, s_->nodes(), t_->gathers.residual);
    t_->gathers.residual.weight.clear();
  }

  // The destination is the lower triangle, at the owner of the larger node; a block met the other way round
  // is marked by complement.
  void gather_blocks_of(std::span<const Index> nodes, std::int64_t slot, std::vector<Contribution>& c) const {
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      for (std::size_t b = 0; b <= a; ++b, ++slot) {
        if (!owns(std::max(nodes[a], nodes[b]))) continue;
        if (nodes[a] >= nodes[b]) {
          c.push_back({key_of(nodes[a], nodes[b]), slot, 1});
        } else {
          c.push_back({key_of(nodes[b], nodes[a]), ~slot, 1});
        }
      }
    }
  }

  void gather_blocks() {
    std::vector<Contribution> c;
    for (std::size_t p = 0; p < s_->parts_.stencil_pools.size(); ++p) {
      const StencilPool& pool = *s_->parts_.stencil_pools[p];
      if (!pool.has_hessian()) continue;
      for (const StencilRun& run : t_->pools.runs[p]) {
        for (Index s = run.begin; s < run.end; ++s)
          gather_blocks_of(pool.nodes()[s], run.hessian + pool.hessian_offset()[at(s)], c);
      }
    }
    // Mass, shifts and prescribed motion need every diagonal block; a source is not needed for one.
    std::vector<bool> has_diagonal(at(s_->nodes()), false);
    for (const auto& e : c) {
      if ((e.key >> 32) == (e.key & 0xffffffffu)) has_diagonal[e.key & 0xffffffffu] = true;
    }
    gather_by_key(c, false, t_->gathers.block, t_->gathers.block_ends);
    for (Index i = 0; i < s_->nodes(); ++i) {
      if (has_diagonal[at(i)] || !owns(i)) continue;
      t_->gathers.block_ends.push_back({i, i});
      t_->gathers.block.offset.push_back(t_->gathers.block.offset.back());
    }
  }

  // The stencils of a solid couple every pair of nodes that share a cell, so each entry has its block.
  void place_mass() {
    auto& entries = s_->parts_.mass_entries;
    if (entries.empty()) return;
    std::vector<std::pair<std::uint64_t, std::size_t>> blocks;
    for (std::size_t d = 0; d < s_->gathers().block_ends.size(); ++d)
      blocks.push_back({key_of(s_->gathers().block_ends[d][0], s_->gathers().block_ends[d][1]), d});
    std::sort(blocks.begin(), blocks.end());
    s_->block_mass_.assign(s_->gathers().block_ends.size(), 0);
    for (const MassEntry& e : entries) {
      if (!owns(e.row)) continue;
      const auto found =
          std::lower_bound(blocks.begin(), blocks.end(), std::pair(key_of(e.row, e.col), std::size_t{0}));
      s_->block_mass_[found->second] += e.value;
    }
  }

  void gather_jacobian() {
    std::vector<Contribution> c;
    for (std::size_t p = 0; p < s_->parts_.row_pools.size(); ++p) {
      const RowPool& rows = *s_->parts_.row_pools[p];
      if (rows.law != RowLaw::compliant) continue;
      const StencilPool& pool = *s_->parts_.stencil_pools[at(rows.stencil_pool)];
      const Index functions = pool.functions();
      for (Index r = 0; r < rows.rows(); ++r) {
        for (Index k = rows.map.offset[at(r)]; k < rows.map.offset[at(r) + 1]; ++k) {
          const Index s = rows.map.item[at(k)] / functions, f = rows.map.item[at(k)] % functions;
          const auto nodes = pool.nodes()[s];
          const StencilRun* run = t_->pools.run_of(rows.stencil_pool, s);
          const std::int64_t first = (run ? run->jacobian : 0) +
                                     static_cast<std::int64_t>(pool.nodes().offset[at(s)]) * functions +
                                     static_cast<std::int64_t>(f) * static_cast<std::int64_t>(nodes.size());
          for (std::size_t a = 0; a < nodes.size(); ++a) {
            c.push_back({key_of(s_->row_data_.first[p] + r, nodes[a]),
                         run ? first + static_cast<std::int64_t>(a) : -1, rows.weight[at(k)]});
          }
        }
      }
    }
    gather_by_key(c, true, t_->gathers.jacobian, t_->gathers.jacobian_ends);
    find_row_begins(t_->gathers, s_->row_data_.compliant);
  }

  void collect_compliance() {
    std::vector<bool> diagonal(at(s_->row_data_.compliant), false);
    for (std::size_t p = 0; p < s_->parts_.row_pools.size(); ++p) {
      const RowPool& pool = *s_->parts_.row_pools[p];
      if (pool.law != RowLaw::compliant) continue;
      const Index base = s_->row_data_.first[p];
      // The tangent of a law takes the place of constant values.
      const LawRows* law = pool.facets().law;
      if (law) s_->row_data_.laws.push_back({static_cast<Index>(p), s_->row_data_.compliance.size()});
      for (const ComplianceEntry& e : pool.compliance) {
        s_->row_data_.compliance.push_back({base + e.row, base + e.col, law ? 0.0 : e.value});
        if (e.row == e.col) diagonal[at(base + e.row)] = true;
      }
    }
    for (Index r = 0; r < s_->row_data_.compliant; ++r) {
      if (!diagonal[at(r)]) s_->row_data_.compliance.push_back({r, r, 0.0});
    }
    s_->row_data_.own_compliance.assign(at(s_->row_data_.compliant), 0);
    for (std::size_t k = 0; k < s_->row_data_.compliance.size(); ++k) {
      const ComplianceEntry& e = s_->row_data_.compliance[k];
      if (e.row == e.col) s_->row_data_.own_compliance[at(e.row)] = k;
    }
    release_idle_rows();
  }

  // Hard rows whose nodes are all given in all directions have no unknown to act on: their line of the matrix
  // would be empty. With their own metric as compliance they have a multiplier, which nothing feels but the
  // reactions of the supports.
  void release_idle_rows() {
    std::vector<double> size(at(s_->row_data_.compliant), 0);
    for (const ComplianceEntry& e : s_->row_data_.compliance) {
      size[at(e.row)] += std::abs(e.value);
      size[at(e.col)] += std::abs(e.value);
    }
    for (const auto& [pool, entry] : s_->row_data_.laws) {
      const auto first = s_->row_data_.first[at(pool)], count = s_->parts_.row_pools[at(pool)]->rows();
      std::fill_n(size.begin() + first, count, 1.0);
    }
    std::vector<std::uint8_t> acts(at(s_->row_data_.compliant), 0);
    for (const auto& [row, node] : s_->gathers().jacobian_ends) {
      if (s_->unknowns().first[at(node) + 1] > s_->unknowns().first[at(node)]) acts[at(row)] = 1;
    }
    for (Index r = 0; r < s_->row_data_.compliant; ++r) {
      if (acts[at(r)] || size[at(r)] > 0) continue;
      s_->row_data_.compliance[s_->row_data_.own_compliance[at(r)]].value = s_->row_data_.metric[at(r)];
      s_->row_data_.idle.push_back(r);
    }
  }

  void collect_bounds() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < s_->parts_.row_pools.size(); ++p) {
      const RowPool& pool = *s_->parts_.row_pools[p];
      if (pool.law != RowLaw::compliant || (pool.lower.empty() && pool.upper.empty())) continue;
      s_->row_data_.lower.resize(at(s_->row_data_.compliant), -infinity);
      s_->row_data_.upper.resize(at(s_->row_data_.compliant), infinity);
      const auto first = s_->row_data_.first[p];
      std::copy(pool.lower.begin(), pool.lower.end(), s_->row_data_.lower.begin() + first);
      std::copy(pool.upper.begin(), pool.upper.end(), s_->row_data_.upper.begin() + first);
      if (!std::isfinite(pool.largest_overshoot)) continue;
      s_->row_data_.overshoot.resize(at(s_->row_data_.compliant), infinity);
      std::fill_n(s_->row_data_.overshoot.begin() + first, pool.rows(), pool.largest_overshoot);
    }
  }

  // Unknowns ascend with nodes and then with rows, so columns come out sorted without a look at their
  // entries.
  void build_kkt() {
    const auto& unknown = t_->treated.unknown;
    std::vector<std::uint64_t> blocks, row_entries, compliance_entries;  // keys: column, row
    for (const auto& [i, j] : t_->gathers.block_ends) blocks.push_back(key_of(j, i));
    for (const FilledRows* rows : {&t_->treated.condensed, &t_->treated.augmented}) {
      for_filled_blocks(*rows, [&](Index i, Index j) {
        if (owns(i)) blocks.push_back(key_of(j, i));
      });
    }
    for (const auto& [row, node] : t_->gathers.jacobian_ends) {
      if (unknown[at(row)] >= 0 && owns(node)) row_entries.push_back(key_of(node, unknown[at(row)]));
    }
    for (const ComplianceEntry& e : s_->row_data_.compliance) {
      if (unknown[at(e.row)] >= 0 && owns_row(e.row))
        compliance_entries.push_back(key_of(unknown[at(e.col)], unknown[at(e.row)]));
    }
    for (auto* keys : {&blocks, &row_entries, &compliance_entries}) {
      sort_by_destination(*keys);
      keys->erase(std::unique(keys->begin(), keys->end()), keys->end());
    }
    SymmetricPattern& kkt = t_->matrix.pattern;
    const auto& first = t_->unknowns.first;
    kkt.size = s_->free_unknowns() + static_cast<Index>(t_->treated.kept.size());
    kkt.row.reserve(9 * blocks.size() + 3 * row_entries.size() + compliance_entries.size());
    kkt.column_start = {0};
    const auto end_of = [](const std::vector<std::uint64_t>& keys, std::size_t from, Index column) {
      while (from < keys.size() && static_cast<Index>(keys[from] >> 32) == column) ++from;
      return from;
    };
    const auto row_of = [](std::uint64_t key) { return static_cast<Index>(key & 0xffffffffu); };
    const auto end_column = [&] { kkt.column_start.push_back(static_cast<std::int64_t>(kkt.row.size())); };
    std::size_t block = 0, entry = 0;
    for (Index j = 0; j < s_->nodes(); ++j) {
      const std::size_t end_of_blocks = end_of(blocks, block, j),
                        end_of_entries = end_of(row_entries, entry, j);
      for (Index c = first[at(j)]; c < first[at(j) + 1]; ++c) {
        for (std::size_t k = block; k < end_of_blocks; ++k) {
          const Index i = row_of(blocks[k]);
          for (Index r = i == j ? c : first[at(i)]; r < first[at(i) + 1]; ++r) kkt.row.push_back(r);
        }
        for (std::size_t k = entry; k < end_of_entries; ++k) kkt.row.push_back(row_of(row_entries[k]));
        end_column();
      }
      block = end_of_blocks;
      entry = end_of_entries;
    }
    entry = 0;
    for (Index u = s_->free_unknowns(); u < kkt.size; ++u) {
      for (const std::size_t end = end_of(compliance_entries, entry, u); entry < end; ++entry)
        kkt.row.push_back(row_of(compliance_entries[entry]));
      end_column();
    }
  }

  // Visits all blocks that rows add to the stiffness. Nodes of a row ascend, so the blocks (i, j) are those
  // of the lower triangle.
  template <class Visit>
  void for_filled_blocks(const FilledRows& rows, Visit visit) const {
    for (const Index row : rows.row) {
      const auto begin = t_->gathers.row_begin[at(row)], end = t_->gathers.row_begin[at(row) + 1];
      for (auto a = begin; a < end; ++a) {
        for (auto b = begin; b <= a; ++b)
          visit(t_->gathers.jacobian_ends[a][1], t_->gathers.jacobian_ends[b][1]);
      }
    }
  }

  std::int64_t place(Index row, Index col) const {
    const auto& kkt = t_->matrix.pattern;
    const auto begin = kkt.row.begin() + kkt.column_start[at(col)];
    const auto end = kkt.row.begin() + kkt.column_start[at(col) + 1];
    return std::lower_bound(begin, end, row) - kkt.row.begin();
  }

  void locate_entries() {
    const auto& first = t_->unknowns.first;
    const auto locate = [&](std::vector<std::int64_t>& places, Index row_or_node, Index node, bool is_row) {
      for (Index k = 0; k < 3; ++k) {
        const Index c = first[at(node)] + k;
        if (c >= first[at(node) + 1]) {
          places.push_back(-1);
        } else if (is_row) {
          const Index u = t_->treated.unknown[at(row_or_node)];
          places.push_back(u < 0 || !owns(node) ? -1 : place(u, c));
        } else if (row_or_node == node) {
          places.push_back(place(c, c));
        } else {
          places.push_back(
              first[at(row_or_node)] < first[at(row_or_node) + 1] ? place(first[at(row_or_node)], c) : -1);
        }
      }
    };
    for (const auto& [i, j] : t_->gathers.block_ends) locate(t_->matrix.block, i, j, false);
    for (const auto& [row, node] : t_->gathers.jacobian_ends) locate(t_->matrix.jacobian, row, node, true);
    for (const ComplianceEntry& e : s_->row_data_.compliance) {
      const Index row = t_->treated.unknown[at(e.row)], col = t_->treated.unknown[at(e.col)];
      t_->matrix.compliance.push_back(row < 0 || !owns_row(e.row) ? -1 : place(row, col));
    }
    for (FilledRows* rows : {&t_->treated.condensed, &t_->treated.augmented}) {
      for_filled_blocks(*rows, [&](Index i, Index j) {
        for (Index c = first[at(j)]; c < first[at(j) + 1]; ++c) {
          const Index from = i == j ? c : first[at(i)];
          rows->place.push_back(owns(i) && from < first[at(i) + 1] ? place(from, c) : -1);
        }
      });
    }
    const auto& owner = t_->matrix.pattern.owner;
    for (Index i = 0; i < t_->matrix.pattern.size; ++i) {
      const bool here = owner.empty() || owner[at(i)] == shares()->rank();
      t_->matrix.diagonal.push_back(here ? t_->matrix.pattern.column_start[at(i)] : -1);
    }
  }

  // The unknowns of a node share a group; a local row joins the node that most of its stencils have in
  // common, so that the ordering sees one vertex a node. Rows over large parts of a body stay apart.
  void group_unknowns() {
    SymmetricPattern& kkt = t_->matrix.pattern;
    kkt.group.assign(at(kkt.size), -1);
    Index groups = 0;
    std::vector<Index> group_of_node(at(s_->nodes()), -1);
    for (Index i = 0; i < s_->nodes(); ++i) {
      for (Index c = t_->unknowns.first[at(i)]; c < t_->unknowns.first[at(i) + 1]; ++c) {
        if (group_of_node[at(i)] < 0) group_of_node[at(i)] = groups++;
        kkt.group[at(c)] = group_of_node[at(i)];
      }
    }
    std::vector<Index> rows_in(at(groups), 0);
    std::size_t e = 0;
    for (Index r = 0; r < s_->row_data_.compliant; ++r) {
      const std::size_t begin = e;
      while (e < t_->gathers.jacobian_ends.size() && t_->gathers.jacobian_ends[e][0] == r) ++e;
      if (t_->treated.unknown[at(r)] < 0) continue;
      Index best = -1;
      std::int64_t best_count = 0;
      if (e - begin <= local_row_nodes) {
        for (std::size_t k = begin; k < e; ++k) {
          const Index g = group_of_node[at(t_->gathers.jacobian_ends[k][1])];
          if (g < 0) continue;
          const std::int64_t count = t_->gathers.jacobian.offset[k + 1] - t_->gathers.jacobian.offset[k];
          if (best < 0 || count > best_count || (count == best_count && rows_in[at(g)] < rows_in[at(best)])) {
            best = g;
            best_count = count;
          }
        }
      }
      if (best < 0) {
        best = groups++;
        rows_in.push_back(0);
      }
      ++rows_in[at(best)];
      kkt.group[at(t_->treated.unknown[at(r)])] = best;
    }
    kkt.groups = groups;
  }

  void find_ordering_base() {
    t_->matrix.pattern.analysis = std::make_shared<SharedAnalysis>();
    if (!s_->renews_stencils()) return;
    if (!s_->parts_.ordering_base) {
      s_->parts_.ordering_base = std::make_shared<OrderingBase>();
      s_->parts_.ordering_base->pattern = t_->matrix.pattern;
    }
    t_->matrix.pattern.base = s_->parts_.ordering_base;
  }

  void hash_layout() {
    Hash h;
    h.add(std::span<const Index>(t_->matrix.pattern.row));
    h.add(std::span<const std::int64_t>(t_->matrix.pattern.column_start));
    h.add(static_cast<std::uint64_t>(s_->nodes()));
    h.add(static_cast<std::uint64_t>(s_->row_data_.compliant));
    h.add(static_cast<std::uint64_t>(s_->row_data_.prescribed));
    t_->layout = h.value();
  }

  std::shared_ptr<System> s_;
  std::shared_ptr<SystemTables> t_;
};

double System::evaluate_law(const LawPlace& place, double t0, double t1, std::span<const double> memory,
                            std::span<const double> lambda, std::span<double> strain,
                            std::span<double> tangent) const {
  const auto first = at(first_row(place.row_pool)), rows = at(parts_.row_pools[at(place.row_pool)]->rows());
  const LawRows& law = *parts_.row_pools[at(place.row_pool)]->facets().law;
  return law.evaluate_law({t0, t1, row_memory(place.row_pool, memory)}, lambda.subspan(first, rows), strain,
                          tangent);
}

const StencilRun* PoolPlaces::run_of(Index pool, Index stencil) const {
  const auto& of_pool = runs[at(pool)];
  const auto next = std::upper_bound(of_pool.begin(), of_pool.end(), stencil,
                                     [](Index s, const StencilRun& run) { return s < run.begin; });
  return next == of_pool.begin() || stencil >= std::prev(next)->end ? nullptr : &*std::prev(next);
}

void System::start_memory(std::span<double> memory) const {
  std::fill(memory.begin(), memory.end(), 0.0);
  for (const auto& rows : facets_.remembering_rows) rows.facet->start(rows.in(memory));
}

Result<std::shared_ptr<System>> System::compile(SystemParts parts, const System* like) {
  SystemCompiler compiler(std::move(parts));
  if (like && compiler.take_tables(*like)) return compiler.system();
  return compiler.run();
}

}  // namespace isochor
