#include "engine/world/lag_terms.h"

namespace isochor {

namespace {

// visit(row, function, weight) of the compliant rows over a pool.
template <class Visit>
void each_function(const System& s, Index pool, Visit&& visit) {
  const auto& pools = s.parts().row_pools;
  for (std::size_t p = 0; p < pools.size(); ++p) {
    const RowPool& rows = *pools[p];
    if (rows.stencil_pool != pool || rows.law != RowLaw::compliant) continue;
    const Index first = s.first_row(static_cast<Index>(p));
    for (Index r = 0; r < rows.rows(); ++r) {
      for (Index i = rows.map.offset[at(r)]; i < rows.map.offset[at(r) + 1]; ++i)
        visit(first + r, rows.map.item[at(i)], rows.weight[at(i)]);
    }
  }
}

}  // namespace

void add_to_rows(const System& s, Index pool, Index first_function, std::span<const double> felt,
                 std::span<double> row) {
  const Index end = first_function + static_cast<Index>(felt.size());
  each_function(s, pool, [&](Index r, Index f, double weight) {
    if (f >= first_function && f < end) row[at(r)] += weight * felt[at(f - first_function)];
  });
}

std::vector<double> of_functions(const System& s, Index pool, std::span<const double> row) {
  const StencilPool& stencils = *s.parts().stencil_pools[at(pool)];
  std::vector<double> out(at(stencils.stencils()) * static_cast<std::size_t>(stencils.functions()));
  each_function(s, pool, [&](Index r, Index f, double weight) { out[at(f)] += weight * row[at(r)]; });
  return out;
}

LagTerms::LagTerms(const System& system, const Assembly& assembly, std::span<const Vec3> x)
    : system_(system) {
  for (const auto& [p, lagged] : system.facets().lagged) {
    const StencilPool& pool = *system.parts().stencil_pools[at(p)];
    Pool& own = pools_.emplace_back();
    own.pool = p;
    own.offset.push_back(0);
    for (Index i = 0; i < pool.stencils(); ++i) {
      const auto n = static_cast<std::int64_t>(pool.nodes()[i].size());
      own.offset.push_back(own.offset.back() + n * n);
    }
    own.block.resize(static_cast<std::size_t>(own.offset.back()));
    own.column.resize(pool.nodes().item.size() * static_cast<std::size_t>(pool.functions()));
    lagged->lag_derivatives(assembly.request(p, Want::hessian, x), {own.offset, own.block, own.column});
  }
}

void LagTerms::add(std::span<const Vec3> dx, std::span<const double> dlambda, std::span<Vec3> force) const {
  for (const Pool& own : pools_) {
    const StencilPool& pool = *system_.parts().stencil_pools[at(own.pool)];
    const auto functions = static_cast<std::size_t>(pool.functions());
    const std::vector<double> multiplier = of_functions(system_, own.pool, dlambda);
    for (Index i = 0; i < pool.stencils(); ++i) {
      const auto nodes = pool.nodes()[i];
      const std::size_t n = nodes.size(), first = functions * at(pool.nodes().offset[at(i)]);
      const auto block = static_cast<std::size_t>(own.offset[at(i)]);
      for (std::size_t a = 0; a < n; ++a) {
        Vec3& sum = force[at(nodes[a])];
        for (std::size_t b = 0; b < n; ++b) sum += own.block[block + a * n + b] * dx[at(nodes[b])];
        for (std::size_t k = 0; k < functions; ++k)
          sum += multiplier[at(i) * functions + k] * own.column[first + k * n + a];
      }
    }
  }
}

void LagTerms::add_transposed(double factor, std::span<const Vec3> way, std::span<Vec3> x,
                              std::span<double> row, Index only) const {
  for (const Pool& own : pools_) {
    if (only >= 0 && own.pool != only) continue;
    const StencilPool& pool = *system_.parts().stencil_pools[at(own.pool)];
    const auto functions = static_cast<std::size_t>(pool.functions());
    std::vector<double> felt(at(pool.stencils()) * functions);
    for (Index i = 0; i < pool.stencils(); ++i) {
      const auto nodes = pool.nodes()[i];
      const std::size_t n = nodes.size(), first = functions * at(pool.nodes().offset[at(i)]);
      const auto block = static_cast<std::size_t>(own.offset[at(i)]);
      for (std::size_t a = 0; a < n; ++a) {
        const Vec3 d = factor * way[at(nodes[a])];
        for (std::size_t b = 0; b < n; ++b)
          x[at(nodes[b])] += transposed_times(own.block[block + a * n + b], d);
        for (std::size_t k = 0; k < functions; ++k)
          felt[at(i) * functions + k] += dot(own.column[first + k * n + a], d);
      }
    }
    add_to_rows(system_, own.pool, 0, felt, row);
  }
}

}  // namespace isochor
