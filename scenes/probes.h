// Points of a body that move with it.
#pragma once

#include <array>
#include <span>
#include <string>

#include "isochor/mesh.h"

namespace isochor {

// A point as a weighted sum of nodes: of the cell that holds it, or of the nearest node.
struct MaterialPoint {
  std::array<Index, 10> nodes{};
  std::array<double, 10> weights{};
  int count = 0;
  // From the point asked for to the nearest node, when it lies clearly outside of all cells [m].
  double distance = 0;

  Vec3 at(std::span<const Vec3> positions) const;
};

MaterialPoint locate(const Mesh& mesh, const Vec3& point);

}  // namespace isochor
