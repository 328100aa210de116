// Where fibers run: directions from a Laplace problem, and fibers that are spread about a direction.
#pragma once

#include <string>
#include <vector>

#include "isochor/export.h"
#include "isochor/materials.h"
#include "isochor/mesh.h"

namespace isochor {

// With the harmonic function phi that is 0 on one side of a body and 1 on the other: directions along its
// gradient, or within its layers, turned from one side to the other as the fibers of a heart or of an artery
// are.
struct LaplaceFibers {
  std::vector<std::string> from, to;  // surfaces or node sets of the mesh: phi = 0, phi = 1
  // Zero: along the gradient g. Otherwise in the layer phi = constant, at an angle [rad] from axis x g (the
  // way round the axis) toward the axis, which goes from `angle_from` to `angle_to` with phi.
  Vec3 axis{};
  double angle_from = 0, angle_to = 0;
};
// Unit vectors, one a cell of the mesh, of any cell type. Refused: sides that are not there or meet, parts of
// the mesh that touch neither, cells in which phi or the way round the axis has no direction.
ISOCHOR_API Result<std::vector<Vec3>> laplace_directions(const Mesh& mesh, const LaplaceFibers& fibers);

// Fibers in all directions n, as many as exp(2 concentration (n . a)^2) says about the direction a of a
// family (Gasser, Ogden & Holzapfel 2006, their b): 0 is all alike, large is along a, negative is across it.
// Each direction pulls by itself, so that those under compression carry nothing.
struct FiberSpread {
  double concentration = 0;
  int rings = 4, around = 8;  // quadrature: cones about a, and directions on each of them over half a turn
};
// The family as several, whose stiffnesses sum up to its own.
ISOCHOR_API Result<std::vector<FiberFamily>> spread_fibers(const FiberFamily& family,
                                                           const FiberSpread& spread);

}  // namespace isochor
