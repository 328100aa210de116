#include "engine/system/system_facets.h"

namespace isochor {

namespace {

template <class Facet>
void add(std::vector<FacetOf<Facet>>& list, std::size_t pool, const Facet* facet) {
  if (facet) list.push_back({static_cast<Index>(pool), facet});
}

template <class Facet>
void add(std::vector<MemoryOf<Facet>>& list, std::size_t pool, const Facet* facet, std::size_t& first) {
  if (!facet) return;
  const auto count = static_cast<std::size_t>(facet->memory());
  list.push_back({{static_cast<Index>(pool), facet}, first, count});
  first += count;
}

}  // namespace

SystemFacets::SystemFacets(std::span<const std::shared_ptr<const StencilPool>> stencil_pools,
                           std::span<const std::shared_ptr<const RowPool>> row_pools) {
  for (std::size_t p = 0; p < row_pools.size(); ++p) {
    const RowFacets f = row_pools[p]->facets();
    add(remembering_rows, p, f.remembering, memory);
    add(turning, p, f.turning);
    if (row_pools[p]->law == RowLaw::compliant && row_pools[p]->rows() > 0) add(impacts, p, f.impact);
  }
  for (std::size_t p = 0; p < stencil_pools.size(); ++p) {
    const StencilFacets f = stencil_pools[p]->facets();
    add(lagged, p, f.lagged);
    add(remembering, p, f.remembering, memory);
    add(barriers, p, f.barrier);
    add(renewed, p, f.renewed);
    add(moving, p, f.moving);
    add(dissipative, p, f.dissipative);
    coupled = coupled || (f.lagged && f.lagged->couples());
  }
}

}  // namespace isochor
