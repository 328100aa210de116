// Combinatorics of the tetrahedron in our (VTK's) order, shared by the readers and the checker.
#pragma once

#include <array>
#include <cmath>

#include "isochor/types.h"

namespace isochor::mesh_files {

// Mid-edge node 4 + k lies on edge k.
inline constexpr std::array<std::array<int, 2>, 6> tet_edges{
    {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

// Faces with their normals pointing out of a positively oriented tetrahedron; face k is opposite corner k.
inline constexpr std::array<std::array<int, 3>, 4> tet_faces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

// Exchanging corners 0 and 1 turns a tetrahedron over; the edges (12)(02) and (03)(13) change places with
// them.
inline constexpr std::array<int, 10> turned_over{1, 0, 2, 3, 4, 6, 5, 8, 7, 9};

// Six times the signed volume [m^3].
inline double volume6(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return dot(cross(b - a, c - a), d - a);
}

inline double length(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

}  // namespace isochor::mesh_files
