// Groups of neighboring nodes, the coarse nodes of multigrid.
#pragma once

#include <vector>

#include "engine/solvers/front/block_matrix.h"

namespace isochor {

// Aggregate of every node of a symmetric pattern; returns how many there are. Greedy in the order of nodes:
// a node with all its neighbors where none is taken yet, then what is left joins its smallest neighbor.
Index aggregate_nodes(const BlockMatrix& pattern, std::vector<Index>& aggregate);

}  // namespace isochor
