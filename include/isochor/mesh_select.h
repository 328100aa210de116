// Faces and nodes of a mesh by where they are, so that effects can name them. For meshes that come without
// groups, or without the group that a load needs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "isochor/export.h"
#include "isochor/mesh.h"
#include "isochor/solids.h"

namespace isochor {

struct PlanePlace {
  Vec3 point{}, normal{};  // [m]; the normal need not be of unit length
};

struct SpherePlace {
  Vec3 center{};      // [m]
  double radius = 0;  // [m]
};

// Faces that are reached from the one nearest to `point` over edges at which the surface turns by less than
// `angle`.
struct SeedPlace {
  Vec3 point{};                       // [m]
  double angle = 0.5235987755982988;  // [rad], 30 degrees
};

// Faces whose outward normal is within `angle` of `direction`.
struct FacingPlace {
  Vec3 direction{};
  double angle = 0.5235987755982988;  // [rad]
};

// A face or node is selected when it fits all that is given, a face with all its nodes. At least one
// criterion, or `of`.
struct MeshSelection {
  std::string name;
  // Surfaces of the mesh, "outer" and "chamber 1", ... included, that faces are chosen from; empty: the whole
  // boundary.
  std::vector<std::string> of;
  std::optional<std::array<Vec3, 2>> box;  // lower and upper corner [m]
  std::optional<PlanePlace> plane;         // on it
  std::optional<SpherePlace> sphere;       // inside it, or on it
  std::optional<TriangleSurface> lies_on;  // this surface, open or closed
  std::optional<FacingPlace> facing;
  std::optional<SeedPlace> seed;  // grown last, over faces that fit the rest
  // How far nodes may be from plane, box, sphere and surface [m]; 0: 1e-5 of the diagonal of the mesh.
  double tolerance = 0;
  // Only scene files use these: where `lies_on` is read from (any file that read_surface() reads), and what
  // its coordinates are multiplied by.
  std::string file;
  double scale = 1;
};

// Boundary faces that fit, nodes_per_face(cell_type) nodes each and wound outward. Errors: criteria that
// contradict themselves, unknown surfaces, nothing that fits.
ISOCHOR_API Result<std::vector<Index>> select_faces(const Mesh& mesh, const MeshSelection& selection);
// Nodes that fit, ascending, inside the body as well; those of faces that fit where `of`, `facing` or `seed`
// is given.
ISOCHOR_API Result<std::vector<Index>> select_nodes(const Mesh& mesh, const MeshSelection& selection);

// Puts what is selected into the mesh under the name of the selection. Refuses names that it has already.
ISOCHOR_API Result<void> add_surface(Mesh& mesh, const MeshSelection& selection);
ISOCHOR_API Result<void> add_node_set(Mesh& mesh, const MeshSelection& selection);

}  // namespace isochor
