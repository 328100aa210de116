// Hard rows that depend on each other, or enclose a body that cannot change its volume.
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "engine/scene/scene_checks.h"

namespace isochor {

namespace {

bool is_hard(const RowPool& pool) {
  if (pool.law != RowLaw::compliant || pool.rows() == 0 || pool.facets().law) return false;
  if (!pool.lower.empty() || !pool.upper.empty()) return false;  // gives way where it would contradict
  // A compliance whose rows sum to zero (a stabilization) leaves the total hard.
  std::vector<double> sum(at(pool.rows()), 0), size(at(pool.rows()), 0);
  for (const ComplianceEntry& e : pool.compliance) {
    sum[at(e.row)] += e.value;
    size[at(e.row)] += std::abs(e.value);
    if (e.row == e.col) continue;
    sum[at(e.col)] += e.value;
    size[at(e.col)] += std::abs(e.value);
  }
  for (std::size_t r = 0; r < sum.size(); ++r) {
    if (std::abs(sum[r]) > 1e-9 * size[r]) return false;
  }
  return true;
}

// One hard row over functions that have the same number wherever they stand for the same cells.
struct HardRow {
  Index pool = -1;  // of parts.row_pools; -1: a volume that supports fix
  Index row = 0;
  Index part = -1;  // of a fixed volume
  std::vector<std::pair<std::int64_t, double>> terms;
};

// Numbers functions: those of solids by body, cell and place in it, so that pools over the same cells meet;
// others by pool.
class FunctionNumbers {
 public:
  explicit FunctionNumbers(const SceneFacts& facts) : facts_(facts) {
    for (const BodyData& b : facts.bodies) {
      if (!b.present()) continue;
      first_.push_back(next_);
      next_ += static_cast<std::int64_t>(b.mesh.cell_count()) * kMost;
    }
    for (std::size_t p = 0; p < facts.parts.stencil_pools.size(); ++p) {
      other_.push_back(next_);
      next_ += static_cast<std::int64_t>(facts.parts.stencil_pools[p]->stencils()) *
               facts.parts.stencil_pools[p]->functions();
    }
  }
  std::int64_t of_cell(std::size_t body, Index cell, int k) const { return first_[body] + cell * kMost + k; }
  std::int64_t operator()(Index pool, Index item) const {
    const auto functions = facts_.parts.stencil_pools[at(pool)]->functions();
    for (std::size_t b = 0; b < facts_.bodies.size(); ++b) {
      const BodyData& body = facts_.bodies[b];
      if (!body.present()) continue;
      for (const RegionData& r : body.regions) {
        if (r.has_volume_pool(pool)) return of_cell(b, r.cells[at(item / functions)], item % functions);
      }
      for (const SpanningVolume& v : body.spanning) {
        if (v.pool != pool) continue;
        const auto& data = static_cast<const SolidPool&>(*facts_.parts.stencil_pools[at(pool)]).data();
        return of_cell(b, data.cell[at(item / functions)], item % functions);
      }
    }
    return other_[at(pool)] + item;
  }

 private:
  static constexpr std::int64_t kMost = 8;  // functions of a cell
  const SceneFacts& facts_;
  std::vector<std::int64_t> first_, other_;
  std::int64_t next_ = 0;
};

std::string name_rows(const SceneFacts& facts, const std::vector<HardRow>& rows,
                      const std::vector<std::size_t>& involved) {
  std::map<Index, std::vector<Index>> by_pool;
  for (const std::size_t i : involved) {
    if (rows[i].pool >= 0) by_pool[rows[i].pool].push_back(rows[i].row);
  }
  std::string names;
  for (const auto& [p, list] : by_pool) {
    const RowPool& pool = *facts.parts.row_pools[at(p)];
    names += (names.empty() ? "\"" : ", \"") + std::string(pool.name()) + "\"";
    if (pool.rows() == 1) continue;
    const auto count = static_cast<Index>(list.size());
    if (count == pool.rows()) {
      names += " (all of its " + std::to_string(count) + " rows)";
    } else {
      names += " (" + std::to_string(count) + " of its " + std::to_string(pool.rows()) + " rows)";
    }
  }
  return names;
}

// Rows of the map that depend on each other whatever the positions: zero pivots of W W^T + C.
Result<void> check_independent_rows(const SceneFacts& facts, const std::vector<HardRow>& rows) {
  const auto count = static_cast<Eigen::Index>(rows.size());
  std::vector<Eigen::Triplet<double>> w, c;
  std::map<std::int64_t, int> column;
  std::map<Index, std::map<Index, Eigen::Index>> place;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    double norm = 0;
    for (const auto& [f, weight] : rows[r].terms) norm += weight * weight;
    for (const auto& [f, weight] : rows[r].terms) {
      const int col = column.emplace(f, static_cast<int>(column.size())).first->second;
      w.emplace_back(static_cast<int>(r), col, weight / std::sqrt(norm));
    }
    if (rows[r].pool >= 0) place[rows[r].pool][rows[r].row] = static_cast<Eigen::Index>(r);
  }
  // Rows are scaled to length one, a stabilization with them: what it maps to zero stays so.
  std::vector<double> length(rows.size());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (const auto& [f, weight] : rows[r].terms) length[r] += weight * weight;
    length[r] = std::sqrt(length[r]);
  }
  for (const auto& [p, of_row] : place) {
    double largest = 1e-300;
    for (const ComplianceEntry& e : facts.parts.row_pools[at(p)]->compliance)
      largest = std::max(largest, std::abs(e.value));
    for (const ComplianceEntry& e : facts.parts.row_pools[at(p)]->compliance) {
      // Rows that were left out are not there.
      if (!of_row.contains(e.row) || !of_row.contains(e.col)) continue;
      const Eigen::Index i = of_row.at(e.row), j = of_row.at(e.col);
      const double v =
          e.value / largest / (length[static_cast<std::size_t>(i)] * length[static_cast<std::size_t>(j)]);
      c.emplace_back(static_cast<int>(i), static_cast<int>(j), v);
      if (i != j) c.emplace_back(static_cast<int>(j), static_cast<int>(i), v);
    }
  }
  Eigen::SparseMatrix<double> W(count, static_cast<Eigen::Index>(column.size())), C(count, count);
  W.setFromTriplets(w.begin(), w.end());
  C.setFromTriplets(c.begin(), c.end());
  // An exact zero would stop the factorization and leave D and L unwritten behind it.
  Eigen::SparseMatrix<double> rounding(count, count);
  rounding.setIdentity();
  const Eigen::SparseMatrix<double> S = Eigen::SparseMatrix<double>(W * W.transpose()) + C + 1e-13 * rounding;
  // A check may not cost more than the solve. Rows that couple so much are left to the solver.
  constexpr Eigen::Index kMostNonzeros = 4'000'000;
  if (S.nonZeros() > kMostNonzeros) return {};
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt(S);
  if (ldlt.info() != Eigen::Success) {
    std::vector<std::size_t> all(rows.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return Error{"hard rows repeat or contradict each other: " + name_rows(facts, rows, all) +
                 "; drop some of them, or give them a compliance (nu < 0.5)"};
  }
  const Eigen::VectorXd D = ldlt.vectorD();
  const double largest = D.maxCoeff();
  Eigen::Index zero = 0;
  while (zero < count && D[zero] > 1e-10 * largest) ++zero;
  if (zero == count) return {};
  // The combination of rows that vanishes: L^T y = e at the first zero pivot, in the order of the pivots.
  Eigen::VectorXd y = Eigen::VectorXd::Unit(count, zero);
  ldlt.matrixL().transpose().solveInPlace(y);
  y = ldlt.permutationPinv() * y;
  std::vector<std::size_t> involved;
  Index part = -1;
  for (Eigen::Index r = 0; r < count; ++r) {
    if (std::abs(y[r]) < 1e-6 * y.cwiseAbs().maxCoeff()) continue;
    involved.push_back(static_cast<std::size_t>(r));
    if (rows[static_cast<std::size_t>(r)].part >= 0) part = rows[static_cast<std::size_t>(r)].part;
  }
  if (part >= 0) {
    return Error{
        "body \"" + facts.bodies[at(part)].name +
        "\" is enclosed: every boundary node is held in the direction of its surface, so hard volume rows "
        "leave the mean pressure undetermined; free part of the boundary, or take nu < 0.5"};
  }
  return Error{"hard rows repeat or contradict each other: " + name_rows(facts, rows, involved) +
               " constrain the same volumes with zero compliance (what one says follows from the others); "
               "drop one of them, or give one a compliance (nu < 0.5)"};
}

// Parts whose whole boundary is held, as a row each: their volume cannot change.
std::vector<HardRow> fixed_volumes(const SceneFacts& facts, const FunctionNumbers& number) {
  Index count = 0;
  const std::vector<Index> part = connected_parts(facts, count);
  std::vector<Vec3> area(facts.parts.rest.size());
  std::vector<double> scale(at(count), 0);
  std::vector<HardRow> rows(at(count));
  for (std::size_t b = 0; b < facts.bodies.size(); ++b) {
    const BodyData& body = facts.bodies[b];
    if (!body.present()) continue;
    const int functions = body.reference->points > 1 ? body.reference->corners : 1;
    for (const RegionData& region : body.regions) {
      const auto data = solid_data(*body.reference, facts.parts.rest, body.global_cells, region.cells,
                                   VolumeFunctions::none);
      if (!data) continue;
      const SolidData& d = data.value();
      for (Index s = 0; s < d.nodes.count(); ++s) {
        const auto nodes = d.nodes[s];
        HardRow& row = rows[at(part[at(nodes[0])])];
        row.part = static_cast<Index>(b);
        for (int k = 0; k < functions; ++k)
          row.terms.emplace_back(number.of_cell(b, region.cells[at(s)], k), 1.0);
        for (int q = 0; q < d.points; ++q) {
          for (std::size_t a = 0; a < nodes.size(); ++a) {
            const Vec3 g =
                d.weight[at(s * d.points + q)] * d.gradient[at(s * d.points + q) * nodes.size() + a];
            area[at(nodes[a])] += g;
            scale[at(part[at(nodes[a])])] = std::max(scale[at(part[at(nodes[a])])], std::sqrt(dot(g, g)));
          }
        }
      }
    }
  }
  std::vector<const PrescribedNode*> given(facts.parts.rest.size(), nullptr);
  for (const PrescribedNode& p : facts.supports.nodes) given[at(p.node)] = &p;
  std::vector<bool> open(at(count), false);
  for (std::size_t i = 0; i < area.size(); ++i) {
    Vec3 free = area[i];
    for (int k = 0; given[i] && k < given[i]->directions; ++k) {
      const Vec3& d = given[i]->direction[static_cast<std::size_t>(k)];
      free -= dot(free, d) * d;
    }
    if (std::sqrt(dot(free, free)) > 1e-7 * scale[at(part[i])]) open[at(part[i])] = true;
  }
  std::vector<HardRow> fixed;
  for (Index c = 0; c < count; ++c) {
    if (!open[at(c)] && !rows[at(c)].terms.empty()) fixed.push_back(std::move(rows[at(c)]));
  }
  return fixed;
}

// Groups of rows that have functions in common, each group by itself.
std::vector<std::vector<HardRow>> connected_groups(std::vector<HardRow> rows) {
  std::vector<std::size_t> root(rows.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto find = [&](std::size_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  std::map<std::int64_t, std::size_t> holder;
  std::map<Index, std::size_t> of_pool;  // a pool's compliance may couple its rows
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (rows[r].pool >= 0) root[find(r)] = find(of_pool.emplace(rows[r].pool, r).first->second);
    for (const auto& [f, weight] : rows[r].terms) root[find(r)] = find(holder.emplace(f, r).first->second);
  }
  std::map<std::size_t, std::vector<HardRow>> groups;
  for (std::size_t r = 0; r < rows.size(); ++r) groups[find(r)].push_back(std::move(rows[r]));
  std::vector<std::vector<HardRow>> out;
  for (auto& [r, group] : groups) out.push_back(std::move(group));
  return out;
}

// Rows that cannot depend on each other, those of one pool that share no function; and pressure spaces, whose
// weights add up to one everywhere: rows at nodes, with a stabilization against what depends, or without one
// because the author took it away.
bool plainly_independent(const SceneFacts& facts, const std::vector<HardRow>& group) {
  for (const HardRow& row : group) {
    if (row.pool != group.front().pool || row.pool < 0) return false;
  }
  if (!facts.parts.row_pools[at(group.front().pool)]->compliance.empty()) return true;
  std::map<std::int64_t, double> sum;
  bool shared = false;
  for (const HardRow& row : group) {
    for (const auto& [f, weight] : row.terms) {
      const auto [it, fresh] = sum.emplace(f, 0.0);
      shared = shared || !fresh;
      it->second += weight;
    }
  }
  return !shared || std::all_of(sum.begin(), sum.end(),
                                [](const auto& entry) { return std::abs(entry.second - 1) < 1e-9; });
}

// A function whose nodes are all held in all directions is what supports make it; rows over such functions
// alone have nothing to act on and are left out (System), unless a stabilization couples them to others.
bool is_fixed(const SceneFacts& facts, Index stencil_pool, Index item, std::span<const std::uint8_t> held) {
  const StencilPool& stencils = *facts.parts.stencil_pools[at(stencil_pool)];
  const auto nodes = stencils.nodes()[item / stencils.functions()];
  return std::all_of(nodes.begin(), nodes.end(), [&](Index n) { return held[at(n)] != 0; });
}

}  // namespace

Result<void> check_hard_rows(const SceneFacts& facts) {
  const FunctionNumbers number(facts);
  std::vector<HardRow> rows;
  Index hard_total = 0;
  std::string names;
  std::set<std::int64_t> fixed;  // functions of cells whose nodes are all held
  std::vector<std::uint8_t> held(facts.parts.rest.size(), 0);
  for (const PrescribedNode& p : facts.supports.nodes) held[at(p.node)] = p.directions == 3 ? 1 : 0;
  for (std::size_t p = 0; p < facts.parts.row_pools.size(); ++p) {
    const RowPool& pool = *facts.parts.row_pools[p];
    if (!is_hard(pool)) continue;
    Index acting = 0;
    for (Index r = 0; r < pool.rows(); ++r) {
      HardRow row{static_cast<Index>(p), r, -1, {}};
      for (Index k = pool.map.offset[at(r)]; k < pool.map.offset[at(r) + 1]; ++k) {
        const Index item = pool.map.item[at(k)];
        const std::int64_t f = number(pool.stencil_pool, item);
        if (pool.compliance.empty() && is_fixed(facts, pool.stencil_pool, item, held))
          fixed.insert(f);
        else
          row.terms.emplace_back(f, pool.weight[at(k)]);
      }
      if (row.terms.empty()) continue;
      ++acting;
      rows.push_back(std::move(row));
    }
    bool stabilized = false;
    for (const ComplianceEntry& e : pool.compliance) stabilized = stabilized || e.value != 0;
    if (!stabilized) {
      hard_total += acting;
      names += (names.empty() ? "\"" : ", \"") + std::string(pool.name()) + "\"";
    }
  }
  Index free = 3 * static_cast<Index>(facts.parts.rest.size());
  for (const PrescribedNode& p : facts.supports.nodes) free -= p.directions;
  if (hard_total > free) {
    return Error{"there are " + std::to_string(hard_total) + " rows without compliance (" + names +
                 ") but only " + std::to_string(free) +
                 " free displacements: the constraints lock or contradict each other; use rows per node or "
                 "per body, or "
                 "nu < 0.5"};
  }
  if (rows.empty()) return {};
  for (HardRow& whole : fixed_volumes(facts, number)) {
    std::erase_if(whole.terms, [&](const auto& term) { return fixed.contains(term.first); });
    if (!whole.terms.empty()) rows.push_back(std::move(whole));
  }
  for (const auto& group : connected_groups(std::move(rows))) {
    if (group.size() < 2 || plainly_independent(facts, group)) continue;
    if (auto r = check_independent_rows(facts, group); !r) return r;
  }
  return {};
}

}  // namespace isochor
