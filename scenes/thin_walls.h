// Walls too thin for their elements: a body whose linear tets have no node inside bends as if it were much
// stiffer, and nothing else says so.
#pragma once

#include <string>
#include <vector>

#include "scenes/scene.h"

namespace isochor {

// A larger share of the volume than this in cells without a node inside: fewer than two elements across.
inline constexpr double kThinWallShare = 0.3;

// The share of the volume in Tet4 cells all of whose nodes lie on the surface. Sides that a support holds
// along their normal are none of it: in plane strain one layer is enough, and behind a plane of symmetry the
// wall goes on. Of other cells 0.
double share_without_inside(const Mesh& mesh, const std::vector<DirichletDef>& supports = {});

// What a scene is told of each such body, in one sentence with the remedy.
std::vector<std::string> thin_walls(const SceneDef& scene, const BuiltScene& built);

// The same of a mesh alone, whose supports are not known; empty where its walls are thick enough for Tet4.
std::string thin_walls(const Mesh& mesh);

}  // namespace isochor
