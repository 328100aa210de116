// Edges of a surface that bulge outward, which may meet each other between the points of the surface, and the
// search for those that do.
#pragma once

#include "constraints/contact/surface/contact_surface.h"
#include "constraints/contact/surface/edge_distance.h"

namespace isochor {

struct SurfaceEdge {
  std::array<Index, kEdgeNodes> node{};  // ends, then the far corners of its triangles, as in EdgeGap
  int side = 0;
  double area = 0;  // a third of its triangles at rest [m^2]
};

class SurfaceEdges {
 public:
  // Edges between two faces whose normals are 20 degrees apart at rest, or more. Flatter ones sink in by 4
  // percent of their length at most before a point of one of the two meets the other side.
  SurfaceEdges(const ContactSurface& surface, std::span<const Vec3> rest);

  Index count() const { return static_cast<Index>(edge_.size()); }
  const SurfaceEdge& operator[](Index e) const { return edge_[at(e)]; }
  double size() const { return size_; }  // as of the surface [m]

  // The nodes of a pair, the first edge first.
  std::array<Index, kPairNodes> nodes(Index edge, Index other) const;
  EdgeGap gap(Index edge, Index other, std::span<const Vec3> x, double offset) const;

  struct Finding {
    Index deepest = -1;  // edge of the other side that this one is deepest in, or closest to within reach
    EdgeGap gap;         // to it
    double before = 0;   // value of the gap to it at `from`
    Index crossed = -1;  // edge that it went through and is far behind
  };
  // For every edge, over the straight way of all nodes from `from` to `x`. `partner`: by edge the one that it
  // has a row with, or -1: what is behind an edge counts only next to what it was in contact with, or went
  // through on this way, since it may as well be the far side of its own body.
  void search(std::span<const Vec3> from, std::span<const Vec3> x, double reach, double offset,
              std::span<const Index> partner, const Parallel* parallel, std::span<Finding> out) const;

 private:
  struct Way {
    std::span<const Vec3> from, x;
    double reach = 0, offset = 0;
    std::span<const Index> partner;
  };
  Finding find(Index edge, const Way& way, std::span<const Box> boxes) const;
  Box swept(Index edge, const Way& way) const;
  bool share_nodes(Index edge, Index other) const;  // of their triangles
  bool beside(Index edge, Index other) const;       // the same, or ends of theirs are
  bool familiar(Index edge, Index other, std::span<const Index> partner) const;

  bool single_ = true;
  double size_ = 0;
  std::vector<SurfaceEdge> edge_;  // side by side
  std::array<Index, 2> first_{};
  std::array<BoxTree, 2> tree_;
};

}  // namespace isochor
