// Points that ride along with a body: weighted sums of node positions.
#pragma once

#include "engine/scene/builder.h"

namespace isochor {

struct PointInBody {
  std::vector<Index> nodes;    // of the scene, ascending
  std::vector<double> weight;  // sum to one

  Vec3 at(std::span<const Vec3> x) const;
};

// The point of the body's cell that holds it at rest, or of the nearest cell, extrapolated: an embedded point
// is where it was asked for, also a little outside a faceted surface. Refused further away than the cell is
// high. Cells are taken with straight edges.
Result<PointInBody> embed(const BodyData& body, std::span<const Vec3> rest, const Vec3& point,
                          const std::string& who);

// Nodes of both with the difference of their weights, second minus first. Nodes that cancel are kept out.
PointInBody difference(const PointInBody& first, const PointInBody& second);

// Largest shear modulus of a body [Pa].
double stiffest(const BodyData& body);

}  // namespace isochor
