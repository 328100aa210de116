// Values painted on the surface of a mesh, carried into its cells.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "isochor/export.h"
#include "isochor/mesh.h"

namespace isochor {

// A point on a boundary face, between corner nodes of the mesh.
struct SurfaceFoot {
  std::array<Index, 3> node{};
  std::array<double, 3> weight{};  // sum to one
};

struct SurfaceFeet {
  std::vector<SurfaceFoot> cell;  // one a cell
  std::vector<double> depth;      // smooth distance to the surface, one a node that is a corner, else 0 [m]
  Index lost = 0;  // cells whose path did not arrive: they have the nearest node of the surface
};

// Projects the center of every cell onto the surface along the gradient of a smooth distance: u with
// -laplace u = 1 inside and u = 0 on the surface, on the linear tets of the mesh. Empty `surfaces`: the whole
// boundary; otherwise these alone, and paths slide along the rest of the boundary.
ISOCHOR_API Result<SurfaceFeet> surface_feet(const Mesh& mesh, std::span<const std::string> surfaces = {});

// What becomes of cells that nothing was painted on.
enum class UnpaintedCells : std::uint8_t {
  none,     // they stay without
  nearest,  // they take the weights of the painted cell that is nearest from cell to cell
};

struct PaintedCells {
  std::vector<std::vector<double>>
      weight;                     // a field: one a cell, 0 to 1; those of a cell add up to at most 1
  Index painted = 0;              // cells with a weight of their own
  Index shared = 0;               // among them with weights of several fields
  Index filled = 0, without = 0;  // cells that took the nearest one's, cells without weights
  Index lost = 0;                 // see SurfaceFeet
};

// Weights in cells from fields of the mesh (Mesh::fields, one component) whose values at nodes of the surface
// lie between 0 and 1; nodes inside do not count. Where several fields add up to more than 1 they are divided
// by their sum; weights below `threshold` count as not painted.
ISOCHOR_API Result<PaintedCells> painted_cells(const Mesh& mesh, std::span<const std::string> fields,
                                               std::span<const std::string> surfaces = {},
                                               UnpaintedCells unpainted = UnpaintedCells::none,
                                               double threshold = 0.01);

}  // namespace isochor
