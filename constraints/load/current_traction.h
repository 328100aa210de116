// Tractions per area as it is, and tractions that vary over a surface.
#pragma once

#include "constraints/stencil/face_pool.h"
#include "engine/scene/builder.h"
#include "isochor/effects/load.h"

namespace isochor {

// Faces in scene node numbers, `per` nodes each, with the traction of every node of theirs at amount 1 [Pa].
struct LoadedFaces {
  std::vector<Index> faces;
  std::size_t per = 3;
  std::vector<Vec3> traction;  // parallel to faces

  std::size_t count() const { return faces.size() / per; }
};

// Factors of the nodes of a mesh, from a field of it with one component; empty name: all 1. The error is the
// end of a sentence.
Result<std::vector<double>> node_factors(const Mesh& mesh, const std::string& field);

// Consistent forces of tractions per area at rest, at amount 1 [N]; nodes may come several times.
std::vector<std::pair<Index, Vec3>> rest_area_forces(const LoadedFaces& faces, std::span<const Vec3> rest);

// Adds the pool and the given multiplier of tractions per area as it is.
void add_current_traction(Builder& builder, const std::string& name, const LoadedFaces& faces, bool lagged,
                          const std::shared_ptr<const Amount>& amount);

}  // namespace isochor
