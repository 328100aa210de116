// Corners, sides and edges of the cells of a mesh, in our (VTK's) order.
#pragma once

#include <array>
#include <cstddef>

#include "isochor/mesh.h"

namespace isochor {

// Sides are listed with their corners running counterclockwise as seen from outside.
struct CellShape {
  std::size_t corners, sides, side_corners, edges;
  std::array<std::array<std::size_t, 4>, 6> side;
  std::array<std::array<std::size_t, 2>, 12> edge;
};

inline constexpr CellShape kTetShape{4,
                                     4,
                                     3,
                                     6,
                                     {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}},
                                     {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}}};

inline constexpr CellShape kHexShape{
    8,
    6,
    4,
    12,
    {{{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}},
    {{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}}};

// The one side of a triangle is what it shows on top.
inline constexpr CellShape kTriShape{3, 1, 3, 3, {{{0, 1, 2}}}, {{{0, 1}, {1, 2}, {2, 0}}}};

constexpr const CellShape& cell_shape(CellType type) {
  return type == CellType::tri3 ? kTriShape : (type == CellType::hex8 ? kHexShape : kTetShape);
}

// Corner a of a hexahedron lies at xi_k = +1 where the sign is +1, at -1 elsewhere.
inline constexpr std::array<std::array<int, 3>, 8> kHexSign{
    {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}};

// Trilinear function of corner a and its derivative by xi, on [-1, 1]^3.
constexpr double hex_function(std::size_t a, const Vec3& xi) {
  const auto& s = kHexSign[a];
  return 0.125 * (1 + s[0] * xi.x) * (1 + s[1] * xi.y) * (1 + s[2] * xi.z);
}
constexpr Vec3 hex_gradient(std::size_t a, const Vec3& xi) {
  const auto& s = kHexSign[a];
  const double x = 1 + s[0] * xi.x, y = 1 + s[1] * xi.y, z = 1 + s[2] * xi.z;
  return {0.125 * s[0] * y * z, 0.125 * s[1] * x * z, 0.125 * s[2] * x * y};
}

// 1 / sqrt(3): the points of the 2 x 2 x 2 Gauss rule lie at plus and minus this.
inline constexpr double kHexGauss = 0.57735026918962576451;

// Corners of the six Kuhn tets of a hexahedron around its diagonal from corner 0 to corner 6.
inline constexpr std::array<std::array<std::size_t, 4>, 6> kHexTets{
    {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}}};

}  // namespace isochor
