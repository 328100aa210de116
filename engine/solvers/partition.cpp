#include "engine/solvers/partition.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "engine/base/base.h"

#ifdef ISOCHOR_HAVE_METIS
#include <metis.h>
#endif

namespace isochor {

namespace {

std::vector<Index> runs_of_nodes(std::span<const Index> weight, Index parts) {
  const auto total = std::accumulate(weight.begin(), weight.end(), std::int64_t{0});
  std::vector<Index> part(weight.size(), 0);
  std::int64_t before = 0;
  for (std::size_t i = 0; i < weight.size(); ++i) {
    part[i] = static_cast<Index>(
        std::min<std::int64_t>(parts - 1, before * parts / std::max<std::int64_t>(total, 1)));
    before += weight[i];
  }
  return part;
}

}  // namespace

std::vector<Index> partition_nodes(std::span<const Index> offset, std::span<const Index> item,
                                   std::span<const Index> weight, Index parts) {
  // A part of a few nodes is all border, and METIS has none to give where there are more parts than nodes.
  constexpr Index fewest_nodes = 8;
  const auto nodes = static_cast<Index>(weight.size());
  parts = std::min(parts, nodes / fewest_nodes);
  if (parts <= 1) return std::vector<Index>(weight.size(), 0);
#ifdef ISOCHOR_HAVE_METIS
  idx_t elements = static_cast<idx_t>(offset.size()) - 1, count = nodes, wanted = parts, cut = 0;
  std::vector<idx_t> start(offset.begin(), offset.end()), list(item.begin(), item.end()),
      cost(weight.begin(), weight.end());
  std::vector<idx_t> element_part(at(static_cast<Index>(elements))), node_part(at(nodes));
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_NUMBERING] = 0;
  if (METIS_PartMeshNodal(&elements, &count, start.data(), list.data(), cost.data(), nullptr, &wanted,
                          nullptr, options, &cut, element_part.data(), node_part.data()) == METIS_OK)
    return {node_part.begin(), node_part.end()};
#else
  (void)offset, (void)item;
#endif
  return runs_of_nodes(weight, parts);
}

}  // namespace isochor
