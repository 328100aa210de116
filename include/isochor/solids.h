// Rigid shapes given by triangles or by distances on a grid, for the obstacles of contacts.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "isochor/export.h"
#include "isochor/types.h"

namespace isochor {

// Triangles in space; three points each, counterclockwise seen from outside.
struct TriangleSurface {
  std::vector<Vec3> points;  // [m]
  std::vector<Index> triangles;
};

// Reads Wavefront (.obj), STL (text and binary), or the boundary of a volume mesh of any kind that read_mesh
// reads. `scale` multiplies coordinates.
ISOCHOR_API Result<TriangleSurface> read_surface(const std::string& path, double scale = 1);

// Signed distances [m] at the points of a regular grid, negative inside.
struct DistanceGrid {
  Vec3 origin{};                 // the first point [m]
  Vec3 spacing{};                // between points, along x, y and z [m]
  std::array<Index, 3> count{};  // points along x, y and z
  std::vector<double> values;    // x runs fastest, then y
};

// Reads VTK legacy files with structured points (the scalars that come first), text or binary, and SDFGen's
// text (.sdf): counts, origin, spacing, values. `scale` multiplies coordinates and distances.
ISOCHOR_API Result<DistanceGrid> read_distances(const std::string& path, double scale = 1);

// A closed rigid shape, prepared once and shared by all obstacles that have it. Immutable.
class Solid;
using SolidPtr = std::shared_ptr<const Solid>;

// The solid inside a closed surface. Points that lie on each other are taken as one, and a surface that is
// wound inward throughout is turned over. Refused are open surfaces, edges of more than two triangles, and
// triangles that run against their neighbors.
ISOCHOR_API Result<SolidPtr> mesh_solid(const TriangleSurface& surface);

// The solid where an interpolated field is negative: cubic splines through the values, so that first and
// second derivatives are continuous. Refused are fields that are negative on the border of the grid or
// nowhere, and fields that are no distances (whose slope at the surface is not about one).
ISOCHOR_API Result<SolidPtr> field_solid(const DistanceGrid& grid);

// Distances to a closed surface on a grid around it, with `spacing` between points and two of them as margin.
ISOCHOR_API Result<DistanceGrid> sampled_distances(const TriangleSurface& surface, double spacing);

}  // namespace isochor
