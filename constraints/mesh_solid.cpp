#include "constraints/mesh_solid.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "constraints/closed_surface.h"

namespace isochor {

namespace {

double norm(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

Vec3 direction(const Vec3& v) {
  const double length = norm(v);
  return length > 0 ? (1 / length) * v : Vec3{};
}

void add_outer(Mat3& m, double s, const Vec3& a) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m(i, j) += s * a[i] * a[j];
  }
}

double square_to_box(const Vec3& y, const Vec3& low, const Vec3& high) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double d = std::max({low[k] - y[k], 0.0, y[k] - high[k]});
    sum += d * d;
  }
  return sum;
}

// Whether the way from `start` by fractions 0 to 1 of `way` meets the box.
bool meets_box(const Vec3& start, const Vec3& way, const Vec3& low, const Vec3& high, double skin) {
  double from = 0, to = 1;
  for (int k = 0; k < 3; ++k) {
    const double a = low[k] - skin - start[k], b = high[k] + skin - start[k];
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

constexpr Index kLeaf = 4;            // triangles
constexpr std::size_t kStack = 128;   // boxes waiting; the tree is halved, so its depth is far below
constexpr double kOnSurface = 1e-10;  // of the extent: directions from the nearest point are noise
constexpr double kSameWay = 5e-6;     // angle up to which two directions are one [rad]

bool same_way(const Vec3& a, const Vec3& b) {
  const Vec3 d = a - b;
  return dot(d, d) < kSameWay * kSameWay;
}

}  // namespace

Result<std::shared_ptr<const MeshSolid>> MeshSolid::make(const TriangleSurface& surface) {
  auto clean = closed_surface(surface);
  if (!clean) return Error{clean.error()};
  auto solid = std::make_shared<MeshSolid>();
  solid->surface_ = std::move(clean).value();
  solid->grow_tree();
  solid->set_normals();
  return std::shared_ptr<const MeshSolid>(std::move(solid));
}

void MeshSolid::grow_tree() {
  const auto count = static_cast<Index>(surface_.triangles.size() / 3);
  order_.resize(at(count));
  std::iota(order_.begin(), order_.end(), 0);
  std::vector<Vec3> middle;
  for (Index t = 0; t < count; ++t) middle.push_back(corner(t, 0) + corner(t, 1) + corner(t, 2));
  tree_.push_back({{}, {}, 0, count, -1});
  for (std::size_t b = 0; b < tree_.size(); ++b) {
    Box box = tree_[b];
    box.low = box.high = corner(order_[at(box.first)], 0);
    for (Index i = box.first; i < box.first + box.count; ++i) {
      for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < 3; ++k) {
          box.low[k] = std::min(box.low[k], corner(order_[at(i)], c)[k]);
          box.high[k] = std::max(box.high[k], corner(order_[at(i)], c)[k]);
        }
      }
    }
    if (box.count > kLeaf) {
      const Vec3 size = box.high - box.low;
      const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
      const auto from = order_.begin() + box.first;
      const Index half = box.count / 2;
      std::nth_element(from, from + half, from + box.count, [&](Index p, Index q) {
        const double u = middle[at(p)][axis], v = middle[at(q)][axis];
        return u < v || (u == v && p < q);
      });
      box.left = static_cast<Index>(tree_.size());
      tree_.push_back({{}, {}, box.first, half, -1});
      tree_.push_back({{}, {}, box.first + half, box.count - half, -1});
    }
    tree_[b] = box;
  }
  extent_ = norm(tree_[0].high - tree_[0].low);
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

// Ericson's regions of a triangle.
void MeshSolid::look_at(const Vec3& y, Index t, Nearest& best) const {
  if (face_normal_[at(t)] == Vec3{}) return;  // no area: its edges are those of its neighbors
  const Vec3 &a = corner(t, 0), &b = corner(t, 1), &c = corner(t, 2);
  const Vec3 ab = b - a, ac = c - a;
  Nearest n;
  n.triangle = t;
  const auto keep = [&](const Vec3& point) {
    n.point = point;
    n.square = dot(y - point, y - point);
    if (best.triangle < 0 || n.square < best.square) best = n;
  };
  const double d1 = dot(ab, y - a), d2 = dot(ac, y - a);
  if (d1 <= 0 && d2 <= 0) return n.corner = 0, keep(a);
  const double d3 = dot(ab, y - b), d4 = dot(ac, y - b);
  if (d3 >= 0 && d4 <= d3) return n.corner = 1, keep(b);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return n.edge = 0, keep(a + (d1 / (d1 - d3)) * ab);
  const double d5 = dot(ab, y - c), d6 = dot(ac, y - c);
  if (d6 >= 0 && d5 <= d6) return n.corner = 2, keep(c);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return n.edge = 2, keep(a + (d2 / (d2 - d6)) * ac);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    return n.edge = 1, keep(b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b));
  }
  const double sum = va + vb + vc;
  keep(a + (vb / sum) * ab + (vc / sum) * ac);
}

MeshSolid::Nearest MeshSolid::nearest(const Vec3& y) const {
  Nearest best;
  struct Waiting {
    Index box;
    double square;
  };
  std::array<Waiting, kStack> stack;
  std::size_t size = 0;
  stack[size++] = {0, 0};
  while (size > 0) {
    const Waiting next = stack[--size];
    if (best.triangle >= 0 && next.square >= best.square) continue;
    const Box& box = tree_[at(next.box)];
    if (box.left < 0) {
      for (Index i = box.first; i < box.first + box.count; ++i) look_at(y, order_[at(i)], best);
      continue;
    }
    Waiting near{box.left, square_to_box(y, tree_[at(box.left)].low, tree_[at(box.left)].high)};
    Waiting far{box.left + 1, square_to_box(y, tree_[at(box.left) + 1].low, tree_[at(box.left) + 1].high)};
    if (far.square < near.square) std::swap(near, far);
    stack[size++] = far;
    stack[size++] = near;
  }
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
  add_outer(d.curvature, -1 / d.value, d.normal);
  add_outer(d.curvature, -1 / d.value,
            direction(corner(n.triangle, n.edge + 1) - corner(n.triangle, n.edge)));
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
  add_outer(d.curvature, -1 / d.value, d.normal);
  add_outer(d.curvature, -1 / d.value, along);
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
  const double skin = 1e-12 * extent_;
  std::array<Index, kStack> stack;
  std::size_t size = 0, found = 0;
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
  stack[size++] = 0;
  while (size > 0) {
    const Box& box = tree_[at(stack[--size])];
    if (!meets_box(y0, way, box.low, box.high, skin)) continue;
    if (box.left >= 0) {
      stack[size++] = box.left;
      stack[size++] = box.left + 1;
      continue;
    }
    for (Index i = box.first; i < box.first + box.count; ++i) {
      // Cramer's rule for y0 + s way = a + u ab + v ac; slightly larger triangles leave no slits.
      const Index t = order_[at(i)];
      const Vec3 ab = corner(t, 1) - corner(t, 0), ac = corner(t, 2) - corner(t, 0), from = y0 - corner(t, 0);
      const Vec3 p = cross(way, ac);
      const double det = dot(ab, p);
      if (det == 0) continue;
      const double u = dot(from, p) / det;
      const Vec3 q = cross(from, ab);
      const double v = dot(way, q) / det, s = dot(ac, q) / det;
      constexpr double slack = 1e-10;
      if (u >= -slack && v >= -slack && u + v <= 1 + slack && s >= 0 && s <= 1) add(s);
    }
  }
  return found;
}

Result<SolidPtr> mesh_solid(const TriangleSurface& surface) {
  auto solid = MeshSolid::make(surface);
  if (!solid) return Error{solid.error()};
  return SolidPtr(std::move(solid).value());
}

}  // namespace isochor
