#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/solvers/front/front_tree.h"
#include "engine/solvers/ordering.h"
#include "engine/system/gather_lists.h"
#include "engine/system/matrix_pattern.h"
#include "engine/system/row_treatment.h"
#include "engine/system/share_out.h"
#include "engine/system/structure.h"

namespace isochor {

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
    MatrixPattern(*s_, *t_).build();
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
