// Signed distance of a point to a few triangles that move, with derivatives in the point and the corners.
#pragma once

#include <span>

#include "engine/base.h"

namespace isochor {

inline constexpr std::size_t kPatchNodes = 6;  // of a triangle and its neighbors across edges
inline constexpr std::size_t kPatchTriangles = 4;

// Corners of the triangles as places in the list of the patch's nodes, counterclockwise from outside. The
// first triangle is in the middle. Those across sharp edges that bulge outward are `sides`: what is beside
// them is not below the patch.
struct Patch {
  std::array<std::array<std::uint8_t, 3>, kPatchTriangles> corner{};
  std::array<bool, kPatchTriangles> side{};
  std::uint8_t triangles = 0, nodes = 0;
  double margin = 0;  // sides are taken to be this much farther out, so that flush edges meet [m]
};

// The nearest point of a patch. Beyond the border of a patch its outer triangles go on as planes, up to where
// the plane of a side is nearer from within: there the distance is that to the side, less the margin.
struct PatchPoint {
  double distance = 0;  // negative behind the patch [m]
  double height = 0;    // the same without the margin of a side [m]
  Vec3 normal{};        // unit: d distance / d point
  std::array<double, kPatchNodes>
      weight{};                          // of the nodes, adding up to one: -weight * normal is their gradient
  bool at_edge = false;                  // between two triangles; otherwise within the plane of one
  std::array<std::uint8_t, 3> corner{};  // of the triangle, or the two of the edge: places in the patch
};

// A patch without area has no distance: infinity, no weights.
PatchPoint nearest_on_patch(const Vec3& p, std::span<const Vec3> x, const Patch& patch);

// Adds factor times the second derivative of the distance to packed blocks (row i, column j <= i at i (i + 1)
// / 2 + j). `coefficient` c of all nodes of a stencil: their share in the motion of the point less that of
// the nearest point of the patch, whose nodes begin at `first`. From n . tangents = 0 follow the rates of the
// nearest point xi and of n; with the dual tangents tau^a, the inverse metric m^ab and the slopes e_ak of the
// weights along xi_a,
//   H_kl = -sum_a (e_ak c_l n tau^a^T + c_k e_al tau^a n^T) - d sum_ab e_ak m^ab e_bl n n^T
//          + c_k c_l (I - n n^T - sum_a tau_a tau^a^T) / d.
// `bending` alone keeps the last term, and only where it is positive for the factor.
void add_patch_curvature(const PatchPoint& point, std::span<const Vec3> x, double factor, bool bending_alone,
                         std::span<const double> coefficient, std::size_t first, Mat3* blocks);

// The first of the fractions (0, 1] of straight ways at which a point goes from the front of a triangle to
// its back through it; 2 where it never does. `start` and `end`: the point, then the corners.
double crossing_time(const std::array<Vec3, 4>& start, const std::array<Vec3, 4>& end);

}  // namespace isochor
