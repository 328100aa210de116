// Signed distance of two edges that cross, with derivatives in their nodes and in those of the triangles at
// them.
#pragma once

#include <span>

#include "engine/base/base.h"

namespace isochor {

inline constexpr std::size_t kEdgeNodes = 4;  // of one edge: its ends, then what its triangles have beside it
inline constexpr std::size_t kPairNodes = 2 * kEdgeNodes;

// Of edges p and q with ends a0, a1 and b0, b1 that bulge outward, (a0, a1, a2) and (a1, a0, a3) triangles
// counterclockwise from outside, and so the b: the common normal n = +-p x q / |p x q| from the second body
// to the first, and distance = n . (a0 - b0), negative where the edges are past each other.
//
// Only edges that would meet count, by a weight from 0 to 1 that is a product of smooth steps (twice
// continuously differentiable): the nearest places lie within both edges, and fade out over a fifth at their
// ends, where corners take over; the triangles at both edges fall away from n, by 2 to 7 degrees at least, so
// that faces that lie flat on each other are left to their points; the edges are not parallel, by 13 degrees,
// where their points see all there is to see. Where the weight is zero, so is the value.
struct EdgeGap {
  double distance = 0;            // [m]
  double weight = 0;              // [-]
  double value = 0;               // weight (distance - offset) [m]
  Vec3 normal{};                  // d distance / d a place of the first edge
  std::array<double, 2> place{};  // of the nearest places along both edges, within [0, 1] where they count
  bool facing = false;            // the triangles fall away from the normal, or nearly do
  bool plain = false;             // no step has a slope here: the value is that of lines
  // Share of node i in the motion of the nearest place of the first edge relative to that of the second, and
  // its slope in the place on the edge that the node belongs to.
  double share(std::size_t i) const {
    const double t = place[i / kEdgeNodes];
    return kSign[i] * (i % kEdgeNodes == 0 ? 1 - t : t);
  }
  static double share_slope(std::size_t i) { return i % kEdgeNodes == 0 ? -kSign[i] : kSign[i]; }

 private:
  static constexpr std::array<int, kPairNodes> kSign{1, 1, 0, 0, -1, -1, 0, 0};
};

EdgeGap edge_gap(const std::array<Vec3, kPairNodes>& x, double offset);

// Slopes of the value by node.
std::array<Vec3, kPairNodes> edge_slopes(const std::array<Vec3, kPairNodes>& x, const EdgeGap& gap,
                                         double offset);
// Slopes by node of the normal (a column a coordinate of the node), of both places, and of the weight; zero
// where edges do not count.
struct EdgeRates {
  std::array<Mat3, kPairNodes> normal{};
  std::array<std::array<Vec3, kPairNodes>, 2> place{};
  std::array<Vec3, kPairNodes> weight{};
};
EdgeRates edge_rates(const std::array<Vec3, kPairNodes>& x, const EdgeGap& gap);
// Adds factor times its second derivative to packed blocks (row i, column j <= i at i (i + 1) / 2 + j).
void add_edge_curvature(const std::array<Vec3, kPairNodes>& x, const EdgeGap& gap, double offset,
                        double factor, Mat3* blocks);

// The first of the fractions (0, 1] of straight ways at which the edges go through each other, from outside
// to inside; kNever where they never do.
double edge_crossing_time(const std::array<Vec3, kPairNodes>& start, const std::array<Vec3, kPairNodes>& end);

}  // namespace isochor
