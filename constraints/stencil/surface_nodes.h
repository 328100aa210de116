// Surfaces of bodies as effects need them for contact: faces, and the area that each node stands for.
#pragma once

#include "engine/scene/builder.h"

namespace isochor {

// Faces of the named surfaces in scene node numbers, or without names all faces of the body that only one
// cell has; nodes_per_face each, wound outward in the latter case.
Result<std::vector<Index>> surface_faces(const Builder& builder, BodyId body,
                                         std::span<const std::string> surfaces, const std::string& who);

// The same faces wound outward, whichever way a name has them. Faces inside the body are refused.
Result<std::vector<Index>> outward_faces(const Builder& builder, BodyId body,
                                         std::span<const std::string> surfaces, const std::string& who);

struct SurfaceNode {
  Index node = -1;
  double area = 0;  // at rest [m^2]
};

// Nodes of faces, ascending, each with its share of the rest area; the shares are positive and add up. A face
// of six nodes counts as four triangles, since its corners would have no share of a consistent integral.
std::vector<SurfaceNode> surface_nodes(std::span<const Index> faces, std::size_t nodes_per_face,
                                       std::span<const Vec3> rest);

}  // namespace isochor
