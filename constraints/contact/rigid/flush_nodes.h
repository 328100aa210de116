// Nodes of a body that lie exactly in a side of an obstacle.
#pragma once

#include "constraints/contact/shape/obstacle_shape.h"
#include "engine/scene/builder.h"

namespace isochor {

// What a node sees of its own body at rest.
struct NodeCells {
  double size = 0;  // the shortest edge of a cell that ends at the node [m]
  Vec3 inward{};    // to the middle of its cells [m]
};
// Of every node of the body, in its own numbers.
std::vector<NodeCells> cells_around(const BodyData& body, std::span<const Vec3> rest);

// A flat side of a shape: unit normal, and its distance from the origin along it, in the axes of the shape.
struct FlatSide {
  Vec3 normal{};
  double place = 0;
};
// Of boxes, of cylinders (the ends), and of meshes (what makes up a twentieth of the surface or more).
std::vector<FlatSide> flat_sides(const Obstacle& shape);

// A body as wide as an obstacle has nodes in the planes of the obstacle's sides: in real numbers they are
// beneath the face that moves in, in rounded ones on either side of its edge, and on the side itself the
// distance is zero however deep the face gets. The distance of a node that lies in the plane of a side, with
// its body on the inner side of that plane, is therefore taken this much farther in: a twentieth of a cell.
// Zero where that would put it into the shape at the start. `y`, `inward`: of the node, in the axes of the
// shape.
Vec3 inset_of_flush(const Obstacle& shape, std::span<const FlatSide> sides, const Vec3& y, const Vec3& inward,
                    double size);

}  // namespace isochor
