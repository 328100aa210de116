#include "constraints/contact/shape/mesh_solid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "constraints/contact/shape/closed_surface.h"
#include "engine/math/triangle.h"

namespace isochor {

namespace {

// Whether the way from `start` by fractions 0 to 1 of `way` meets the box.
bool meets_box(const Vec3& start, const Vec3& way, const Box& box, double margin) {
  double from = 0, to = 1;
  for (int k = 0; k < 3; ++k) {
    const double a = box.low[k] - margin - start[k], b = box.high[k] + margin - start[k];
    if (way[k] == 0) {
      if (a > 0 || b < 0) return false;
      continue;
    }
    const double s = a / way[k], t = b / way[k];
    from = std::max(from, std::min(s, t));
    to = std::min(to, std::max(s, t));
  }
  return from <= to;
}

constexpr double kOnSurface = 1e-10;  // of the extent: directions from the nearest point are noise
constexpr double kSameWay = 5e-6;     // angle up to which two directions are one [rad]

bool same_way(const Vec3& a, const Vec3& b) {
  const Vec3 d = a - b;
  return dot(d, d) < kSameWay * kSameWay;
}

}  // namespace

Result<std::shared_ptr<const MeshSolid>> MeshSolid::make(const TriangleSurface& surface) {
  auto clean = closed_surface(surface);
  if (!clean) return clean.failure();
  auto solid = std::make_shared<MeshSolid>();
  solid->surface_ = std::move(clean).value();
  solid->grow_tree();
  solid->set_normals();
  return std::shared_ptr<const MeshSolid>(std::move(solid));
}

void MeshSolid::grow_tree() {
  const auto box_of = [this](Index t) {
    Box box(corner(t, 0));
    box.add(corner(t, 1));
    box.add(corner(t, 2));
    return box;
  };
  tree_.build(static_cast<Index>(surface_.triangles.size() / 3), box_of);
  boxes_ = tree_.fitted(box_of);
  extent_ = norm(boxes_[0].high - boxes_[0].low);
}

void MeshSolid::set_normals() {
  const auto count = static_cast<Index>(surface_.triangles.size() / 3);
  corner_normal_.assign(surface_.points.size(), {});
  across_.assign(surface_.triangles.size(), -1);
  std::vector<std::vector<Index>> around(surface_.points.size());
  std::map<std::pair<Index, Index>, Index> by_edge;
  const auto number = [&](Index t, int k) { return surface_.triangles[at(3 * t + k % 3)]; };
  for (Index t = 0; t < count; ++t) {
    const Vec3 n = direction(cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0)));
    face_normal_.push_back(n);
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = direction(corner(t, k + 1) - corner(t, k)),
                 b = direction(corner(t, k + 2) - corner(t, k));
      corner_normal_[at(number(t, k))] += std::atan2(norm(cross(a, b)), dot(a, b)) * n;
      around[at(number(t, k))].push_back(t);
      by_edge[{number(t, k), number(t, k + 1)}] = t;
    }
  }
  for (const auto& list : around) around_.push(list);
  for (Index t = 0; t < count; ++t) {
    for (int k = 0; k < 3; ++k) across_[at(3 * t + k)] = by_edge.at({number(t, k + 1), number(t, k)});
  }
}

void MeshSolid::look_at(const Vec3& y, Index t, Nearest& best) const {
  if (face_normal_[at(t)] == Vec3{}) return;  // no area: its edges are those of its neighbors
  const TrianglePoint found = nearest_on_triangle(y, corner(t, 0), corner(t, 1), corner(t, 2));
  Nearest n;
  for (int k = 0; k < 3; ++k) n.point += found.weight[static_cast<std::size_t>(k)] * corner(t, k);
  n.square = dot(y - n.point, y - n.point);
  n.triangle = t;
  n.corner = found.corner;
  n.edge = found.edge;
  if (best.triangle < 0 || n.square < best.square) best = n;
}

MeshSolid::Nearest MeshSolid::nearest(const Vec3& y) const {
  Nearest best;
  tree_.visit_near(boxes_, y, [&](Index t) {
    look_at(y, t, best);
    return best.triangle < 0 ? std::numeric_limits<double>::infinity() : best.square;
  });
  return best;
}

Vec3 MeshSolid::outward(const Nearest& n) const {
  if (n.corner >= 0) return corner_normal_[at(surface_.triangles[at(3 * n.triangle + n.corner)])];
  const Vec3 own = face_normal_[at(n.triangle)];
  return n.edge < 0 ? own : own + face_normal_[at(across_[at(3 * n.triangle + n.edge)])];
}

double MeshSolid::value(const Vec3& y) const {
  const Nearest n = nearest(y);
  if (n.corner < 0 && n.edge < 0) return dot(y - n.point, face_normal_[at(n.triangle)]);
  return dot(y - n.point, outward(n)) < 0 ? -std::sqrt(n.square) : std::sqrt(n.square);
}

// Like a cylinder about the edge. Where the direction is that of a face, it is the face that counts: edges
// within a flat side have no curvature.
Distance MeshSolid::at_edge(const Nearest& n, Distance d) const {
  for (const Index t : {n.triangle, across_[at(3 * n.triangle + n.edge)]}) {
    if (!same_way(face_normal_[at(t)], d.normal)) continue;
    d.normal = face_normal_[at(t)];
    return d;
  }
  for (int i = 0; i < 3; ++i) d.curvature(i, i) = 1 / d.value;
  add_outer(d.curvature, -1 / d.value, d.normal, d.normal);
  const Vec3 along = direction(corner(n.triangle, n.edge + 1) - corner(n.triangle, n.edge));
  add_outer(d.curvature, -1 / d.value, along, along);
  return d;
}

// Like a sphere about the corner; like a cylinder where the direction is across an edge that ends there.
Distance MeshSolid::at_corner(const Nearest& n, Distance d) const {
  const Index point = surface_.triangles[at(3 * n.triangle + n.corner)];
  Vec3 along{};
  for (const Index t : around_[point]) {
    if (same_way(face_normal_[at(t)], d.normal)) {
      d.normal = face_normal_[at(t)];
      return d;
    }
    for (int k = 0; k < 3; ++k) {
      if (surface_.triangles[at(3 * t + k)] != point) continue;
      const Vec3 e = direction(corner(t, k + 1) - corner(t, k));
      if (std::abs(dot(e, d.normal)) < kSameWay) along = e;
    }
  }
  for (int i = 0; i < 3; ++i) d.curvature(i, i) = 1 / d.value;
  add_outer(d.curvature, -1 / d.value, d.normal, d.normal);
  add_outer(d.curvature, -1 / d.value, along, along);
  return d;
}

Distance MeshSolid::distance(const Vec3& y) const {
  const Nearest n = nearest(y);
  const Vec3 out = outward(n);
  Distance d;
  if (n.corner < 0 && n.edge < 0) {
    d.value = dot(y - n.point, out);
    d.normal = out;
    return d;
  }
  const double length = std::sqrt(n.square);
  d.value = dot(y - n.point, out) < 0 ? -length : length;
  if (length <= kOnSurface * extent_) {
    d.normal = direction(out);
    return d;
  }
  d.normal = (1 / d.value) * (y - n.point);
  return n.edge >= 0 ? at_edge(n, d) : at_corner(n, d);
}

std::size_t MeshSolid::crossings(const Vec3& y0, const Vec3& y1, std::span<double> out) const {
  const Vec3 way = y1 - y0;
  const double margin = 1e-12 * extent_;
  std::size_t found = 0;
  const auto add = [&](double s) {
    // One crossing, though an edge belongs to two triangles.
    for (std::size_t i = 0; i < found; ++i) {
      if (std::abs(out[i] - s) < 1e-12) return;
    }
    // Where there is no room, the nearest stay.
    if (found == out.size() && !(s < out[found - 1])) return;
    std::size_t i = found < out.size() ? found++ : found - 1;
    for (; i > 0 && out[i - 1] > s; --i) out[i] = out[i - 1];
    out[i] = s;
  };
  const auto cross_triangle = [&](Index t) {
    // Cramer's rule for y0 + s way = a + u ab + v ac; slightly larger triangles leave no slits.
    const Vec3 ab = corner(t, 1) - corner(t, 0), ac = corner(t, 2) - corner(t, 0), from = y0 - corner(t, 0);
    const Vec3 p = cross(way, ac);
    const double det = dot(ab, p);
    if (det == 0) return;
    const double u = dot(from, p) / det;
    const Vec3 q = cross(from, ab);
    const double v = dot(way, q) / det, s = dot(ac, q) / det;
    constexpr double slack = 1e-10;
    if (u >= -slack && v >= -slack && u + v <= 1 + slack && s >= 0 && s <= 1) add(s);
  };
  tree_.visit(
      boxes_, [&](const Box& box) { return meets_box(y0, way, box, margin); }, cross_triangle);
  return found;
}

Result<SolidPtr> mesh_solid(const TriangleSurface& surface) {
  auto solid = MeshSolid::make(surface);
  if (!solid) return solid.failure();
  return SolidPtr(std::move(solid).value());
}

}  // namespace isochor
