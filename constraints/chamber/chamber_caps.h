// What closes the openings of a chamber: a fan over a free rim, and caps in symmetry planes.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "constraints/stencil/face_pool.h"
#include "engine/scene/builder.h"

namespace isochor {

// Fan over a loop from the corner that comes first by its rest position: the cap of a free rim is then the
// same however the nodes are numbered.
void add_cap(EnclosedVolumePool& pool, std::vector<Index> loop, std::span<const Vec3> rest, bool curved);

// An opening that lies on several symmetry planes, such as that of an eighth of a sphere. Its nodes slide in
// their planes, so a cap must stay in them too: a fan over nodes would cut the corner and pull on the rim.
// The volume is taken from a point that all planes share, where their caps add nothing; a plane that misses
// the point (the second of two parallel ones) gets a fan from a fixed apex.
class SymmetryCaps {
 public:
  SymmetryCaps(const Builder& builder, double length) : builder_(builder), length_(length) {}

  bool planar(const std::vector<Index>& loop) const;

  // Finds the plane of every edge; false when an edge lies on none.
  bool add_loop(const std::vector<Index>& loop, std::size_t stride);

  // The common point nearest to `start`, and the apex of every plane.
  Vec3 place(const Vec3& start);

  // What closes the gap between the fans of two planes must lie in a plane through the origin.
  bool fits(const Vec3& origin) const;

  void add_to(EnclosedVolumePool& pool, const Vec3& origin) const;

 private:
  struct Plane {
    Vec3 normal{};
    double offset = 0;
    Vec3 apex{};
  };
  struct Loop {
    std::vector<Index> nodes;
    std::size_t stride;
    std::vector<std::size_t> planes;  // of each edge
  };

  bool on(std::size_t k, const Vec3& x) const;

  // A direction in which both ends (and the middle) are held and along which the edge does not extend.
  std::optional<std::size_t> plane_of(Index a, Index b, Index middle);

  const Builder& builder_;
  double length_;
  std::vector<Plane> planes_;
  std::vector<Vec3> frame_;
  std::vector<Loop> loops_;
};

}  // namespace isochor
