// A few numbers that move the rest positions of a body.
#pragma once

#include <string>
#include <vector>

#include "isochor/mesh.h"

namespace isochor::design {

// A surface that moves as one: along its outward normals, or along an axis.
struct Move {
  std::string surface;
  char along = 'n';            // 'n', 'x', 'y', 'z'
  double least = 0, most = 0;  // [m]
};

// Nodes of the surface of each move go along it by its number; held nodes stay; those between follow
// smoothly: every component solves Laplace's equation on the edges of the mesh, weighted with one over their
// length, so that nothing moves farther than what it lies between. Without `hold` all else of the boundary is
// held.
class Morph {
 public:
  static Result<Morph> make(const Mesh& mesh, const std::vector<Move>& moves,
                            const std::vector<std::string>& hold);

  // One vector a node, for each move at 1 m.
  const std::vector<std::vector<Vec3>>& motions() const { return motions_; }
  std::vector<Vec3> nodes(const std::vector<double>& amounts) const;
  // The least Jacobian determinant at corners of cells over that of the mesh as it came: 1 where nothing
  // moves, 0 where a cell is flat.
  double quality(const std::vector<double>& amounts) const;
  double volume(const std::vector<double>& amounts) const;  // [m^3]
  const Mesh& mesh() const { return mesh_; }

 private:
  Mesh mesh_;
  std::vector<std::vector<Vec3>> motions_;
};

}  // namespace isochor::design
