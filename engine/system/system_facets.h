// Which pools of a system are more than stencils or rows, asked once when it is compiled.
#pragma once

#include "engine/system/pool.h"

namespace isochor {

template <class Facet>
struct FacetOf {
  Index pool = -1;
  const Facet* facet = nullptr;
};

// With numbers that are kept between steps, and where they are among those of all pools.
template <class Facet>
struct MemoryOf : FacetOf<Facet> {
  std::size_t first = 0, count = 0;
  template <class T>
  std::span<T> in(std::span<T> all) const {
    return all.subspan(first, count);
  }
};

struct SystemFacets {
  SystemFacets() = default;
  SystemFacets(std::span<const std::shared_ptr<const StencilPool>> stencil_pools,
               std::span<const std::shared_ptr<const RowPool>> row_pools);

  std::vector<FacetOf<LaggedStencils>> lagged;
  std::vector<MemoryOf<RememberingStencils>> remembering;
  std::vector<FacetOf<BarrierStencils>> barriers;
  std::vector<FacetOf<RenewedStencils>> renewed;
  std::vector<FacetOf<MovingStencils>> moving;
  std::vector<FacetOf<DissipativeStencils>> dissipative;
  std::vector<MemoryOf<RememberingRows>> remembering_rows;
  std::vector<FacetOf<ImpactRows>> impacts;  // compliant rows, one or more
  std::vector<FacetOf<TurningRows>> turning;
  bool coupled = false;    // some lagged stencils want unsymmetric matrices
  std::size_t memory = 0;  // numbers of all pools: those of rows come first
};

}  // namespace isochor
