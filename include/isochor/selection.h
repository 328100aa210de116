// Parts of a body, by name or by place.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "isochor/ids.h"

namespace isochor {

// Nodes (or faces) of a body, by one or several criteria; what fits any of them is selected.
struct Selection {
  BodyId body{};
  std::vector<std::string> surfaces, regions, node_sets;
  std::vector<Index> nodes;                // indices into the body's mesh
  std::vector<std::array<Vec3, 2>> boxes;  // lower and upper corner [m], rest positions
  std::vector<Vec3> nearest;               // the node nearest to each point
  bool everything = false;
};

}  // namespace isochor
