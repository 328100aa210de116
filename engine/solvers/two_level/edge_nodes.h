// Which nodes lie in the middle of an edge, by what a matrix and the places of its nodes tell.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/solvers/saddle_matrix.h"

namespace isochor {

struct EdgeNodes {
  std::vector<std::array<Index, 2>> ends;  // of each node of the matrix; -1: it is no middle
  Index count = 0;
};

// A node is the middle of the nearest two nodes that it and they have in common entries with: within a tenth
// of their distance, so that edges may be curved. On straight edges of meshes whose cells meet in whole faces
// nothing else is as near. An end is no middle itself. A wrong guess costs iterations, no more.
EdgeNodes find_edge_nodes(const SaddleMatrix& matrix, const BlockMatrix& stiffness,
                          std::span<const UnknownGeometry> geometry);

}  // namespace isochor
