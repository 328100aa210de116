#include "constraints/contact/shape/solid.h"

#include <algorithm>
#include <cmath>

namespace isochor {

namespace {

constexpr std::size_t kMostCrossings = 64;

// How far it is from a point of the surface straight through the solid to its other side.
double thickness(const Solid& solid, const Vec3& p, const Vec3& normal, double extent) {
  const double margin = 1e-7 * extent;
  const Vec3 start = p - margin * normal, end = p - extent * normal;
  std::array<double, 1> met{};
  return solid.crossings(start, end, met) > 0 ? margin + met[0] * (extent - margin) : extent;
}

}  // namespace

bool passes_through_solid(const Solid& solid, const Vec3& y0, const Vec3& y1, Vec3& met) {
  const Vec3 way = y1 - y0;
  const auto [low, high] = solid.box();
  const double extent = norm(high - low), length = norm(way);
  // What rests on the surface moves by rounding only.
  if (!(length > 1e-7 * extent)) return false;
  std::array<double, kMostCrossings + 2> place{};
  const std::size_t n = solid.crossings(y0, y1, std::span(place).subspan(1, kMostCrossings));
  if (n == 0) return false;
  place[n + 1] = 1;
  const auto on_way = [&](double s) { return y0 + s * way; };
  const auto inside = [&](std::size_t k) { return solid.value(on_way(0.5 * (place[k] + place[k + 1]))) < 0; };
  constexpr double deep = 0.25, same_side = 0.5;  // of the thickness; cosine between the normals
  constexpr int samples = 8;
  for (std::size_t k = 0; k <= n; ++k) {
    if (!inside(k)) continue;
    std::size_t last = k;
    while (last < n && inside(last + 1)) ++last;
    const double enters = place[k], leaves = place[last + 1];
    const Vec3 entry = on_way(enters);
    const Vec3 normal = solid.distance(entry).normal;
    if (dot(normal, solid.distance(on_way(leaves)).normal) < same_side * norm(normal)) {
      double deepest = 0;
      for (int i = 1; i <= samples; ++i)
        deepest = std::max(deepest, -solid.value(on_way(enters + (leaves - enters) * i / samples)));
      if (deepest > deep * thickness(solid, entry, normal, extent)) {
        met = entry;
        return true;
      }
    }
    k = last;
  }
  return false;
}

}  // namespace isochor
