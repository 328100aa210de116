#include "scenes/run/section_plane.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace isochor {

namespace {

const Vec3& point(std::span<const Vec3> points, Index i) {
  return points[static_cast<std::size_t>(i)];
}

// The connected piece of every triangle, as the number of one of its points.
std::vector<Index> pieces(std::size_t points, std::span<const Index> triangles) {
  std::vector<Index> root(points);
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](Index i) {
    while (root[static_cast<std::size_t>(i)] != i) {
      auto& up = root[static_cast<std::size_t>(i)];
      i = up = root[static_cast<std::size_t>(up)];
    }
    return i;
  };
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
    for (std::size_t k = 1; k < 3; ++k)
      root[static_cast<std::size_t>(find(triangles[t + k]))] = find(triangles[t]);
  }
  std::vector<Index> out;
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) out.push_back(find(triangles[t]));
  return out;
}

// Area enclosed by the lines in which the plane meets the triangles, pieces one by one. Lines left open (a
// chamber without its cap) are closed through their middle.
double shown_area(std::span<const Vec3> points, std::span<const Index> triangles,
                  std::span<const Index> piece, int axis, double place) {
  struct Loop {
    Vec3 start;
    double twice = 0;
  };
  std::vector<Loop> loops(points.size());
  std::vector<bool> begun(points.size(), false);
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
    Vec3 ends[2];
    int found = 0, rising = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = point(points, triangles[t + k]), &b = point(points, triangles[t + (k + 1) % 3]);
      if ((a[axis] < place) == (b[axis] < place) || found == 2) continue;
      const double s = (place - a[axis]) / (b[axis] - a[axis]);
      if (a[axis] < place) rising = found;
      ends[found++] = a + s * (b - a);
    }
    if (found < 2) continue;
    const auto p = static_cast<std::size_t>(piece[t / 3]);
    if (!begun[p]) loops[p].start = ends[0];
    begun[p] = true;
    const Vec3 a = ends[rising] - loops[p].start, b = ends[1 - rising] - loops[p].start;
    loops[p].twice += a[u] * b[v] - a[v] * b[u];
  }
  double area = 0;
  for (const Loop& l : loops) area += 0.5 * std::abs(l.twice);
  return area;
}

// Middles of the whole and of the pieces along an axis; of many pieces the first few.
std::vector<double> candidates(std::span<const Vec3> points, std::span<const Index> triangles,
                               std::span<const Index> piece, int axis) {
  constexpr std::size_t kMost = 32;
  std::vector<Index> known;
  std::vector<std::array<double, 2>> extent{{INFINITY, -INFINITY}};
  for (std::size_t t = 0; t < piece.size(); ++t) {
    auto at = static_cast<std::size_t>(std::find(known.begin(), known.end(), piece[t]) - known.begin());
    if (at == known.size()) {
      if (at == kMost) continue;
      known.push_back(piece[t]);
      extent.push_back({INFINITY, -INFINITY});
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = point(points, triangles[3 * t + k])[axis];
      for (const std::size_t e : {std::size_t{0}, at + 1})
        extent[e] = {std::min(extent[e][0], x), std::max(extent[e][1], x)};
    }
  }
  std::vector<double> out;
  // A hair beside the middle, where symmetric meshes have their nodes.
  for (const auto& [low, high] : extent) out.push_back(0.5 * (low + high) + 1e-6 * (high - low));
  return out;
}

}  // namespace

PageSection section_through(std::span<const Vec3> points, std::span<const Index> triangles, char up) {
  PageSection section;
  const std::vector<Index> piece = pieces(points.size(), triangles);
  double best = -1;
  const std::array<int, 3> order = up == 'y' ? std::array{2, 0, 1} : std::array{1, 0, 2};
  for (const int axis : order) {
    double shown = -1;
    for (const double place : candidates(points, triangles, piece, axis)) {
      const double area = shown_area(points, triangles, piece, axis, place);
      if (area <= 1.02 * shown) continue;
      shown = area;
      section.at[axis] = place;
    }
    if (shown <= (axis == order.back() ? 2.5 : 1.02) * best) continue;
    best = shown;
    section.axis = axis;
  }
  return section;
}

}  // namespace isochor
