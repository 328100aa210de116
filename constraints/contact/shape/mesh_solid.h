// The solid inside a closed triangle surface: signed distances by the closest point, found in a tree of
// boxes.
#pragma once

#include "constraints/contact/box_tree.h"
#include "constraints/contact/shape/solid.h"

namespace isochor {

class MeshSolid final : public Solid {
 public:
  // A reason why there is no solid inside, or none.
  static Result<std::shared_ptr<const MeshSolid>> make(const TriangleSurface& surface);

  Distance distance(const Vec3& y) const override;
  double value(const Vec3& y) const override;
  std::size_t crossings(const Vec3& y0, const Vec3& y1, std::span<double> out) const override;
  std::array<Vec3, 2> box() const override { return {boxes_[0].low, boxes_[0].high}; }
  TriangleSurface outline() const override { return surface_; }
  void describe(Fingerprint& f) const override { f.add(surface_); }

 private:
  // What of a triangle is nearest to a point.
  struct Nearest {
    double square = 0;  // of the distance
    Vec3 point{};
    Index triangle = -1;
    int corner = -1, edge = -1;  // both -1: the face; edge k runs from corner k to the next
  };
  const Vec3& corner(Index triangle, int k) const {
    return surface_.points[at(surface_.triangles[at(3 * triangle + k % 3)])];
  }
  void grow_tree();
  void set_normals();
  Nearest nearest(const Vec3& y) const;
  void look_at(const Vec3& y, Index triangle, Nearest& best) const;
  // Outward at the nearest feature; its length does not matter.
  Vec3 outward(const Nearest& n) const;
  Distance at_edge(const Nearest& n, Distance d) const;
  Distance at_corner(const Nearest& n, Distance d) const;

  TriangleSurface surface_;
  double extent_ = 0;
  std::vector<Vec3> face_normal_;    // unit; zero where a triangle has no area
  std::vector<Vec3> corner_normal_;  // of points, weighted by angles
  std::vector<Index> across_;        // the triangle behind edge k of triangle t, at 3 t + k
  Lists around_;                     // triangles at each point
  BoxTree tree_;
  std::vector<Box> boxes_;
};

}  // namespace isochor
