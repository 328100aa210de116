// Surfaces of soft bodies for contact between them: triangles that move with their nodes, points on them that
// contact is integrated over, and the search for what is close.
#pragma once

#include "constraints/contact/box_tree.h"
#include "constraints/contact/surface/patch_distance.h"
#include "engine/base/parallel.h"

namespace isochor {

// A point of a surface: a corner, the middle of an edge or that of a triangle. On a sharp edge there is one
// for each of the sheets that meet there.
struct SurfacePoint {
  std::array<Index, kFaceNodes> node{};
  std::array<double, kFaceNodes> weight{};
  std::size_t nodes = 0;
  int side = 0;     // 0 or 1
  Index sheet = 0;  // part of the surface between sharp edges
  double area = 0;  // that it stands for, at rest [m^2]

  Vec3 position(std::span<const Vec3> x) const {
    Vec3 p{};
    for (std::size_t k = 0; k < nodes; ++k) p += weight[k] * x[at(node[k])];
    return p;
  }
};

// Faces of 3, 4 or 6 nodes of the scene, counterclockwise from outside. Those of a thin body are there twice,
// with its upper and then with its lower side out; the two are no neighbors of each other.
struct SurfaceFaces {
  std::vector<Index> faces;
  std::size_t per = 3;
  std::size_t lower = 0;  // entry of `faces` where the lower side begins; 0: there is none
};

class ContactSurface {
 public:
  // Those of one side contact the other, those of a single one each other. Faces are searched as triangles:
  // those of six nodes as four, those of four as two.
  ContactSurface(const std::array<SurfaceFaces, 2>& sides, std::span<const Vec3> rest);

  Index triangles() const { return static_cast<Index>(corner_.size()); }
  bool single() const { return single_; }
  const std::vector<SurfacePoint>& points() const { return points_; }
  // Triangles that a point belongs to.
  std::span<const Index> triangles_at(Index point) const { return at_point_[point]; }
  const std::array<Index, 3>& corners(Index triangle) const { return corner_[at(triangle)]; }
  int side(Index triangle) const { return side_[at(triangle)]; }
  // The triangle across edge k, from corner k to the next, smooth or sharp but outward; -1 where there is
  // none.
  Index across(Index triangle, std::size_t k) const {
    return std::max(across_[at(triangle)][k], side_across_[at(triangle)][k]);
  }
  bool same_face(Index triangle, Index other) const {
    return part_[at(triangle)].face == part_[at(other)].face;
  }
  // Mean edge of a triangle at rest [m], over all of them.
  double size() const { return size_; }

  // The patch around a triangle as a point sees it: its neighbors across edges, but those that the point
  // belongs to, and its nodes in the scene. Sharp edges that bulge outward lead to sides; those that turn
  // inward end it.
  struct Around {
    Patch patch;
    std::array<Index, kPatchNodes> node{};
  };
  Around around(Index triangle, Index point) const;

  // Whether the surface at a point and a triangle face each other.
  bool facing(Index point, Index triangle, std::span<const Vec3> x) const;

  struct Finding {
    Index nearest = -1;  // triangle that faces the point and has it above or below it, within reach at x
    double distance = 0;
    Index crossed = -1;  // triangle that the point went through from front to back on its way
  };
  // For every point, over the straight way of all nodes from `from` to `x`. `center`: the triangle by point
  // that its patch is around now, or -1; what a point is in contact with it leaves a little later than it
  // would enter.
  void search(std::span<const Vec3> from, std::span<const Vec3> x, double reach,
              std::span<const Index> center, const Parallel* parallel, std::span<Finding> out) const;
  bool in_patch(Index center, Index triangle, Index point) const;

 private:
  // A triangle that is searched: part of a face.
  struct Part {
    std::size_t nodes = 3;
    std::array<Index, kFaceNodes> face{};
    std::array<std::uint8_t, 3> local{0, 1, 2};
  };
  void add_face(std::span<const Index> face, int side);
  void add_points(std::span<const Vec3> rest);
  // How a triangle that faces a point lies to it; no triangle where it does not count.
  struct Candidate {
    Index triangle = -1;
    double square = 0, height = 0;
  };
  Candidate candidate(Index triangle, Index point, Index center, const Vec3& p,
                      std::span<const Vec3> x) const;
  void keep_nearer(Candidate& best, const Candidate& c) const;
  Finding find(Index point, std::span<const Vec3> from, std::span<const Vec3> x, double reach, Index center,
               std::span<const Box> boxes) const;
  void split_at_sharp_edges(std::span<const Vec3> rest);
  std::vector<Index> sheets() const;
  bool touches(Index triangle, const SurfacePoint& point) const;
  bool neighbors(Index triangle, Index other) const;  // share a node, or are the same

  bool single_ = true;
  double size_ = 0;
  std::vector<std::array<Index, 3>> corner_, across_, side_across_;  // neighbor behind edge k, -1: none
  std::vector<bool> at_border_;  // by node: whether a smooth part of the surface ends there
  std::vector<Part> part_;
  std::vector<int> side_;
  std::vector<SurfacePoint> points_;
  Lists at_point_;
  std::array<BoxTree, 2> tree_;
  std::array<Index, 2> first_{};  // triangle of a side
};

}  // namespace isochor
