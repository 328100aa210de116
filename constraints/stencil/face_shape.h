// Shape functions of faces with their first and second derivatives.
#pragma once

#include "engine/base/base.h"

namespace isochor {

inline constexpr std::size_t kFaceNodes = 6;

// (u, v) of a triangle are the weights of its corners 1 and 2; of a quadrangle they run from 0 to 1 along its
// edges 01 and 03.
struct FaceShape {
  std::array<double, kFaceNodes> N{}, u{}, v{}, uu{}, uv{}, vv{};
};

// Faces of 3 nodes, of 4 (corners in turn) or of 6 (corners, then the middles of 01, 12, 20).
inline FaceShape face_shape(std::size_t nodes, double u, double v) {
  const double w = 1 - u - v;
  if (nodes == 3) return {{w, u, v}, {-1, 1, 0}, {-1, 0, 1}, {}, {}, {}};
  if (nodes == 4) {
    return {{(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v},
            {-(1 - v), 1 - v, v, -v},
            {-(1 - u), -u, u, 1 - u},
            {},
            {1, -1, 1, -1},
            {}};
  }
  return {{w * (2 * w - 1), u * (2 * u - 1), v * (2 * v - 1), 4 * w * u, 4 * u * v, 4 * v * w},
          {1 - 4 * w, 4 * u - 1, 0, 4 * (w - u), 4 * v, -4 * v},
          {1 - 4 * w, 0, 4 * v - 1, -4 * u, 4 * u, 4 * (w - v)},
          {4, 4, 0, -8, 0, 0},
          {4, 0, 0, -4, 4, -4},
          {4, 0, 4, 0, 0, -8}};
}

// Where the nodes of a face are in (u, v).
inline std::array<double, 2> face_place(std::size_t nodes, std::size_t node) {
  constexpr std::array<std::array<double, 2>, 6> triangle{
      {{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}}};
  constexpr std::array<std::array<double, 2>, 4> quadrangle{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  return nodes == 4 ? quadrangle[node] : triangle[node];
}

}  // namespace isochor
