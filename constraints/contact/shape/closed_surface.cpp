#include "constraints/contact/shape/closed_surface.h"

#include <cmath>
#include <map>
#include <tuple>

#include "engine/base/base.h"

namespace isochor {

namespace {

std::string shown(const Vec3& p) {
  char text[96];
  std::snprintf(text, sizeof text, "(%.6g, %.6g, %.6g)", p.x, p.y, p.z);
  return text;
}

Result<void> check_numbers(const TriangleSurface& s) {
  if (s.triangles.empty() || s.triangles.size() % 3 != 0) {
    return Error{"the surface has " + std::to_string(s.triangles.size()) +
                 " corners of triangles; three for each of at least four triangles are needed"};
  }
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    if (!std::isfinite(dot(s.points[i], s.points[i]))) {
      return Error{"point " + std::to_string(i) + " of the surface is not finite; repair the surface"};
    }
  }
  for (std::size_t i = 0; i < s.triangles.size(); ++i) {
    if (s.triangles[i] < 0 || at(s.triangles[i]) >= s.points.size()) {
      return Error{"triangle " + std::to_string(i / 3) + " of the surface names point " +
                   std::to_string(s.triangles[i]) + " of " + std::to_string(s.points.size()) +
                   "; correct the indices"};
    }
  }
  return {};
}

TriangleSurface merged(const TriangleSurface& s) {
  TriangleSurface out;
  std::map<std::tuple<double, double, double>, Index> seen;
  std::vector<Index> number(s.points.size(), -1);
  const auto place = [&](Index i) {
    Index& n = number[at(i)];
    if (n >= 0) return n;
    // Adding zero makes one of the two zeros.
    const Vec3 p = s.points[at(i)] + Vec3{};
    const auto [found, fresh] = seen.try_emplace({p.x, p.y, p.z}, static_cast<Index>(out.points.size()));
    if (fresh) out.points.push_back(p);
    return n = found->second;
  };
  for (std::size_t t = 0; t < s.triangles.size(); t += 3) {
    const Index a = place(s.triangles[t]), b = place(s.triangles[t + 1]), c = place(s.triangles[t + 2]);
    if (a != b && b != c && c != a) out.triangles.insert(out.triangles.end(), {a, b, c});
  }
  return out;
}

}  // namespace

Result<TriangleSurface> closed_surface(const TriangleSurface& surface) {
  if (auto r = check_numbers(surface); !r) return r.failure();
  TriangleSurface s = merged(surface);
  struct Sides {
    int forward = 0, backward = 0;
  };
  std::map<std::pair<Index, Index>, Sides> edges;
  for (std::size_t i = 0; i < s.triangles.size(); ++i) {
    const Index a = s.triangles[i], b = s.triangles[i % 3 == 2 ? i - 2 : i + 1];
    ++(a < b ? edges[{a, b}].forward : edges[{b, a}].backward);
  }
  std::size_t open = 0, many = 0, turned = 0;
  std::pair<Index, Index> first_open, first_many, first_turned;
  for (const auto& [edge, n] : edges) {
    const int sides = n.forward + n.backward;
    if (sides == 1 && open++ == 0) first_open = edge;
    if (sides > 2 && many++ == 0) first_many = edge;
    if (sides == 2 && n.forward != 1 && turned++ == 0) first_turned = edge;
  }
  const auto where = [&](const std::pair<Index, Index>& e) {
    return ", the first from " + shown(s.points[at(e.first)]) + " to " + shown(s.points[at(e.second)]) +
           " m; ";
  };
  if (open > 0) {
    return Error{"the surface is open: " + std::to_string(open) + " edges have a triangle on one side only" +
                 where(first_open) + "close the holes, since only a closed surface has an inside"};
  }
  if (many > 0) {
    return Error{"the surface branches: " + std::to_string(many) + " edges have more than two triangles" +
                 where(first_many) + "export the outer surface of one solid"};
  }
  if (turned > 0) {
    return Error{"the surface is wound both ways: at " + std::to_string(turned) +
                 " edges the triangles on the two sides run against each other" + where(first_turned) +
                 "make the normals consistent (\"recalculate outside\" in most mesh editors)"};
  }
  const double volume = s.triangles.empty() ? 0 : moments_of(s).volume;
  if (volume < 0) {
    for (std::size_t t = 0; t < s.triangles.size(); t += 3) std::swap(s.triangles[t + 1], s.triangles[t + 2]);
  }
  Vec3 low = s.points.empty() ? Vec3{} : s.points[0], high = low;
  for (const Vec3& p : s.points) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  const double size = std::sqrt(dot(high - low, high - low));
  if (!(std::abs(volume) > 1e-12 * size * size * size)) {
    return Error{"the surface encloses no volume; the outside of a solid is needed, not a sheet"};
  }
  return s;
}

// Sums over the tetrahedra that the triangles span with one point.
SolidMoments moments_of(const TriangleSurface& s) {
  SolidMoments m;
  const Vec3 origin = s.points[at(s.triangles[0])];
  Vec3 first{};
  std::array<double, 6> second{};
  constexpr int kPair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  for (std::size_t t = 0; t < s.triangles.size(); t += 3) {
    const Vec3 a = s.points[at(s.triangles[t])] - origin, b = s.points[at(s.triangles[t + 1])] - origin,
               c = s.points[at(s.triangles[t + 2])] - origin, sum = a + b + c;
    const double v = dot(a, cross(b, c)) / 6;
    m.volume += v;
    first += 0.25 * v * sum;
    for (std::size_t e = 0; e < 6; ++e) {
      const int i = kPair[e][0], j = kPair[e][1];
      second[e] += v / 20 * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + sum[i] * sum[j]);
    }
  }
  if (m.volume == 0) return m;
  const Vec3 mean = (1 / m.volume) * first;
  m.middle = origin + mean;
  for (std::size_t e = 0; e < 6; ++e)
    m.second[e] = second[e] / m.volume - mean[kPair[e][0]] * mean[kPair[e][1]];
  return m;
}

}  // namespace isochor
