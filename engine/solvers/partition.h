// Shares of a mesh for several processes: connected where they can be, of about the same cost.
#pragma once

#include <span>
#include <vector>

#include "isochor/types.h"

namespace isochor {

// The part of each node, 0 .. parts - 1. `offset` and `item` are lists of nodes that belong together, and
// `weight` is what each node costs. By METIS where it is built in, else runs of nodes as they are numbered.
// The same input has the same parts.
std::vector<Index> partition_nodes(std::span<const Index> offset, std::span<const Index> item,
                                   std::span<const Index> weight, Index parts);

}  // namespace isochor
