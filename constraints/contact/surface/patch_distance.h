// Signed distance of a point to a few faces that move, with derivatives in the point and the nodes.
#pragma once

#include <span>

#include "constraints/stencil/face_shape.h"

namespace isochor {

inline constexpr std::size_t kPatchNodes = 9;  // of a face and what lies across its edges
inline constexpr std::size_t kPatchTriangles = 4;

// Triangles as places in the list of the patch's nodes, counterclockwise from outside; the first is in the
// middle. Those across sharp edges that bulge outward are `sides`: what is beside them is not below the
// patch. The first triangle may be part of a face of four or six nodes, which then are the first of the
// patch.
struct Patch {
  std::array<std::array<std::uint8_t, 3>, kPatchTriangles> corner{};
  std::array<bool, kPatchTriangles> side{};
  std::uint8_t triangles = 0, nodes = 0;
  std::uint8_t face = 3;  // nodes of the face that the first triangle is part of
  double margin = 0;      // sides are taken to be this much farther out, so that flush edges meet [m]
};

// The nearest point of a patch. Beyond the border of a patch its outer faces go on, up to where the plane of
// a side is nearer from within: there the distance is that to the side, less the margin.
struct PatchPoint {
  double distance = 0;  // negative behind the patch [m]
  double height = 0;    // the same without the margin of a side [m]
  Vec3 normal{};        // unit: d distance / d point
  std::array<double, kPatchNodes>
      weight{};  // of the nodes, adding up to one: -weight * normal is their gradient
  // Of the face, or of the edge between two triangles, that the point is on: its dimensions, tangents, the
  // slopes of the weights along them, and the second derivatives of the place times the normal (aa, ab, bb).
  std::size_t dimensions = 2;
  std::array<Vec3, 2> tangent{};
  std::array<std::array<double, kPatchNodes>, 2> slope{};
  std::array<double, 3> bend{};
};

// A patch without area has no distance: infinity, no weights.
PatchPoint nearest_on_patch(const Vec3& p, std::span<const Vec3> x, const Patch& patch);

// Adds factor times the second derivative of the distance to packed blocks (row i, column j <= i at i (i + 1)
// / 2 + j). `coefficient` c of all nodes of a stencil: their share in the motion of the point less that of
// the nearest point of the patch, whose nodes begin at `first`. The rates of the nearest place xi and of the
// normal n follow from n . tau_a = 0, tau_a the tangents, tau^a their duals, e_ka the slopes of the weights
// and A_ab = tau_a . tau_b - d n . x_ab:
//   d xi_a / d y_l = A^ab (c_l tau_b + d e_lb n)^T
//   d n / d y_l    = -tau^a (e_la n^T + n . x_ab d xi_b / d y_l) + c_l (I - n n^T - sum_a tau_a tau^a^T) / d
//   H_kl           = -e_ka n (d xi_a / d y_l) + c_k (d n / d y_l);
// the last term is there at edges alone. `bending` keeps only that, and only where it is positive for the
// factor.
void add_patch_curvature(const PatchPoint& point, double factor, bool bending,
                         std::span<const double> coefficient, std::size_t first, Mat3* blocks);

// d xi_a / d y_l and d n / d y_l of these for one node: `coefficient` c_l, and its place in the patch
// (kPatchNodes or more: it moves the point alone).
struct PatchRate {
  std::array<Vec3, 2> foot{};
  Mat3 normal;
};
PatchRate patch_rate(const PatchPoint& point, double coefficient, std::size_t node);

// The first of the fractions (0, 1] of straight ways at which a point goes from the front of a triangle to
// its back through it; 2 where it never does. `start` and `end`: the point, then the corners.
double crossing_time(const std::array<Vec3, 4>& start, const std::array<Vec3, 4>& end);

}  // namespace isochor
