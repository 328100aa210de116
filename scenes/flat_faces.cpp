#include "scenes/flat_faces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <vector>

#include "engine/base/base.h"
#include "engine/mesh/boundary.h"

namespace isochor {

FlatFaces flat_faces(const Mesh& mesh) {
  constexpr double degree = 0.017453292519943295, flat = 1 * degree, sharp = 40 * degree;
  const TriangleSurface surface = boundary_of(mesh);
  const std::size_t faces = surface.triangles.size() / 3;
  std::vector<Vec3> normal(faces);  // times twice the area
  std::map<std::pair<Index, Index>, std::vector<std::size_t>> around;
  for (std::size_t f = 0; f < faces; ++f) {
    const Index* n = surface.triangles.data() + 3 * f;
    const auto x = [&](std::size_t k) { return surface.points[at(n[k])]; };
    normal[f] = cross(x(1) - x(0), x(2) - x(0));
    for (std::size_t k = 0; k < 3; ++k) around[std::minmax(n[k], n[(k + 1) % 3])].push_back(f);
  }
  FlatFaces out;
  std::vector<double> turn(faces, 0);
  for (const auto& [edge, of] : around) {
    if (of.size() != 2) continue;
    const Vec3 &a = normal[of[0]], &b = normal[of[1]];
    const double angle = std::atan2(norm(cross(a, b)), dot(a, b));
    if (!(angle > flat) || angle > sharp) continue;
    out.turn = std::max(out.turn, angle);
    for (const std::size_t f : of) turn[f] = std::max(turn[f], angle);
  }
  // The turn that a tenth of the surface exceeds: inner walls count, though outer ones are larger.
  std::vector<std::size_t> by_turn(faces);
  std::iota(by_turn.begin(), by_turn.end(), std::size_t{0});
  std::sort(by_turn.begin(), by_turn.end(), [&](std::size_t f, std::size_t g) { return turn[f] > turn[g]; });
  double area = 0, above = 0;
  for (const Vec3& n : normal) area += norm(n);
  for (const std::size_t f : by_turn) {
    above += norm(normal[f]);
    if (above < 0.1 * area) continue;
    out.deficit = turn[f] * turn[f] / 6;
    break;
  }
  return out;
}

}  // namespace isochor
