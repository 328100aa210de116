// Signed distance of a point to a few triangles that move, with derivatives in the point and the corners.
#pragma once

#include <span>

#include "engine/base.h"

namespace isochor {

inline constexpr std::size_t kPatchNodes = 6;  // of a triangle and its neighbors across edges
inline constexpr std::size_t kPatchTriangles = 4;

// Corners of the triangles as places in the list of the patch's nodes, counterclockwise from outside.
struct Patch {
  std::array<std::array<std::uint8_t, 3>, kPatchTriangles> corner{};
  std::uint8_t triangles = 0, nodes = 0;
};

// The nearest point of a patch.
struct PatchPoint {
  double distance = 0;  // negative behind the patch [m]
  Vec3 normal{};        // unit: d distance / d point
  std::array<double, kPatchNodes>
      weight{};                // of the nodes in the nearest point: -weight * normal is their gradient
  std::size_t dimensions = 2;  // of what is nearest: a corner 0, an edge 1, a face 2
  std::array<std::uint8_t, 3> corner{};  // its dimensions + 1 corners, places in the patch
};

// A patch without area has no distance: infinity, no weights.
PatchPoint nearest_on_patch(const Vec3& p, std::span<const Vec3> x, const Patch& patch);

// Adds factor times the second derivative of the distance to packed blocks (row i, column j <= i at i (i + 1)
// / 2 + j). `coefficient` of all nodes of a stencil: their share in the motion of the point less that of the
// nearest point of the patch, whose nodes begin at `first`. From n . tangents = 0 follow the rates of the
// nearest point xi and of n; tau^a are the dual tangents, e_ak = d weight_k / d xi_a:
//   H_kl = -sum_a (e_ak c_l n tau^a^T + c_k e_al tau^a n^T) - d sum_ab e_ak m^ab e_bl n n^T  (c patch nodes:
//   -weight)
//          + c_k c_l (I - n n^T - sum_a tau_a tau^a^T) / d.
// `bending` alone keeps the last term, and only where it is positive for the factor.
void add_patch_curvature(const PatchPoint& point, std::span<const Vec3> x, double factor, bool bending_alone,
                         std::span<const double> coefficient, std::size_t first, Mat3* blocks);

// The first of the fractions (0, 1] of straight ways at which a point goes from the front of a triangle to
// its back through it; 2 where it never does. `start` and `end`: the point, then the corners.
double crossing_time(const std::array<Vec3, 4>& start, const std::array<Vec3, 4>& end);

}  // namespace isochor
