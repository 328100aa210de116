// Loads on faces that vary over the surface or in time, or that go with the area as it is.
#pragma once

#include <optional>

#include "constraints/stencil/face_pool.h"
#include "engine/math/expression.h"
#include "engine/scene/builder.h"
#include "isochor/effects/load.h"

namespace isochor {

// Faces in scene node numbers, `per` nodes each, with the factor of every node of theirs on a traction, or on
// a pressure where there is none, at amount 1.
struct LoadedFaces {
  std::vector<Index> faces;
  std::size_t per = 3;
  std::optional<Vec3> traction;         // [Pa]; none: a pressure of 1 Pa that pushes inward
  std::vector<double> factor;           // parallel to faces
  std::optional<Expression> profile{};  // a factor on top, at `place`
  std::vector<Vec3> place{};            // parallel to faces: rest positions [m]

  std::size_t count() const { return faces.size() / per; }
  bool varies_in_time() const { return profile && profile->depends_on_time(); }
  double factor_at(std::size_t entry, double t) const {
    return profile ? factor[entry] * (*profile)(place[entry], t) : factor[entry];
  }
};

// With the factors of a field and of an expression, either of them empty: none. The error is the end of a
// sentence.
Result<LoadedFaces> loaded_faces(const Builder& builder, const BodyData& body,
                                 const std::vector<Index>& faces, const std::string& field,
                                 const std::string& profile);

// Forces of tractions per area at rest, at amount 1: that on a node is `area` times the factor of another one
// of its face, times the traction.
struct RestAreaForces {
  struct Share {
    Index node = -1;        // that the force is on
    std::size_t entry = 0;  // of LoadedFaces, whose factor it is
    double area = 0;        // integral of both their shape functions [m^2]
  };
  explicit RestAreaForces(const LoadedFaces& faces, std::span<const Vec3> rest);
  std::vector<Share> shares;
};

// Consistent forces of tractions per area at rest, at amount 1 and time 0 [N]; nodes may come several times.
std::vector<std::pair<Index, Vec3>> rest_area_forces(const LoadedFaces& faces, std::span<const Vec3> rest);

// Adds the pool and the given multiplier of loads per area as it is.
void add_varying_load(Builder& builder, const std::string& name, LoadedFaces faces, bool lagged,
                      const std::shared_ptr<const Amount>& amount);

}  // namespace isochor
