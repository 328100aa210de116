#include "constraints/contact/surface/contact_surface.h"

#include <cmath>
#include <limits>
#include <map>

#include "engine/math/triangle.h"

namespace isochor {

namespace {

Vec3 area_vector(const std::array<Index, 3>& c, std::span<const Vec3> x) {
  return 0.5 * cross(x[at(c[1])] - x[at(c[0])], x[at(c[2])] - x[at(c[0])]);
}

// How far beside a border a point may be to come into contact and to stay in it, over the size of a face.
constexpr double kEnter = 1e-3, kLeave = 0.05;
// Depth, over the same, that is rounding.
constexpr double kShallow = 1e-3;

// Normals at 105 degrees or more. Those of two sides that are flush are perpendicular, give or take a strain.
bool face_each_other(const Vec3& n, const Vec3& m) {
  return dot(n, m) < -0.25 * norm(n) * norm(m);
}

}  // namespace

void ContactSurface::add_face(std::span<const Index> face, int side) {
  constexpr std::array<std::array<std::uint8_t, 3>, 4> six{{{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};
  const auto add = [&](const std::array<std::uint8_t, 3>& local) {
    Part part;
    part.nodes = face.size();
    std::copy(face.begin(), face.end(), part.face.begin());
    part.local = local;
    part_.push_back(part);
    corner_.push_back({face[local[0]], face[local[1]], face[local[2]]});
    across_.push_back({-1, -1, -1});
    side_.push_back(side);
  };
  if (face.size() == 6) {
    for (const auto& local : six) add(local);
  } else if (face.size() == 4) {
    // The diagonal from the smallest node number, whatever node comes first.
    const bool even = (std::min_element(face.begin(), face.end()) - face.begin()) % 2 == 0;
    add(even ? std::array<std::uint8_t, 3>{0, 1, 2} : std::array<std::uint8_t, 3>{1, 2, 3});
    add(even ? std::array<std::uint8_t, 3>{0, 2, 3} : std::array<std::uint8_t, 3>{1, 3, 0});
  } else {
    add({0, 1, 2});
  }
}

ContactSurface::ContactSurface(const std::array<SurfaceFaces, 2>& sides, std::span<const Vec3> rest)
    : single_(sides[1].faces.empty()) {
  double edges = 0;
  for (std::size_t side = 0; side < 2; ++side) {
    first_[side] = triangles();
    const auto& [faces, per, lower] = sides[side];
    for (std::size_t f = 0; f < faces.size(); f += per)
      add_face(std::span(faces).subspan(f, per), static_cast<int>(side));
    std::map<std::pair<Index, Index>, std::pair<std::size_t, std::size_t>> open;
    for (std::size_t t = at(first_[side]); t < corner_.size(); ++t) {
      if (lower > 0 && t == at(first_[side]) + lower / 3) open.clear();
      for (std::size_t k = 0; k < 3; ++k) {
        const Index a = corner_[t][k], b = corner_[t][(k + 1) % 3];
        edges += norm(rest[at(b)] - rest[at(a)]);
        const auto [it, fresh] = open.emplace(std::pair(std::min(a, b), std::max(a, b)), std::pair(t, k));
        if (fresh) continue;
        across_[t][k] = static_cast<Index>(it->second.first);
        across_[it->second.first][it->second.second] = static_cast<Index>(t);
      }
    }
    tree_[side].build(triangles() - first_[side], [&](Index i) {
      Box box(rest[at(corner_[at(first_[side] + i)][0])]);
      for (const Index n : corner_[at(first_[side] + i)]) box.add(rest[at(n)]);
      return box;
    });
  }
  size_ = corner_.empty() ? 0 : edges / static_cast<double>(3 * corner_.size());
  split_at_sharp_edges(rest);
  add_points(rest);
}

// Surfaces go on smoothly up to a fold of 60 degrees.
void ContactSurface::split_at_sharp_edges(std::span<const Vec3> rest) {
  constexpr double least_cosine = 0.5;
  side_across_.assign(corner_.size(), {-1, -1, -1});
  for (std::size_t t = 0; t < corner_.size(); ++t) {
    for (Index& other : across_[t]) {
      if (other < 0) continue;
      const Vec3 n = area_vector(corner_[t], rest), m = area_vector(corner_[at(other)], rest);
      if (dot(n, m) >= least_cosine * norm(n) * norm(m)) continue;
      // Outward when the far corner of the neighbor is below the plane.
      Vec3 far{};
      for (const Index c : corner_[at(other)]) far += rest[at(c)] - rest[at(corner_[t][0])];
      if (dot(n, far) < 0) side_across_[t][static_cast<std::size_t>(&other - across_[t].data())] = other;
      other = -1;
    }
  }
  at_border_.assign(rest.size(), false);
  for (std::size_t t = 0; t < corner_.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (across_[t][k] >= 0) continue;
      at_border_[at(corner_[t][k])] = at_border_[at(corner_[t][(k + 1) % 3])] = true;
    }
  }
}

// Numbers of the parts that sharp edges leave, by triangle.
std::vector<Index> ContactSurface::sheets() const {
  std::vector<Index> sheet(corner_.size(), -1), waiting;
  Index count = 0;
  for (Index t = 0; t < triangles(); ++t) {
    if (sheet[at(t)] >= 0) continue;
    sheet[at(t)] = count;
    waiting.assign(1, t);
    while (!waiting.empty()) {
      const Index next = waiting.back();
      waiting.pop_back();
      for (const Index other : across_[at(next)]) {
        if (other < 0 || sheet[at(other)] >= 0) continue;
        sheet[at(other)] = count;
        waiting.push_back(other);
      }
    }
    ++count;
  }
  return sheet;
}

// The Newton-Cotes rule of degree three, all of whose weights are positive: corners, middles of edges, the
// middle of the triangle. Neighbors share its points, so they sample corners and edges of a surface.
void ContactSurface::add_points(std::span<const Vec3> rest) {
  constexpr double at_corner = 1.0 / 20, at_edge = 2.0 / 15, at_middle = 9.0 / 20;
  const std::vector<Index> sheet = sheets();
  // A point is the same for faces that give it the same nodes with the same weights.
  using Share = std::pair<Index, long>;
  std::map<std::pair<Index, std::array<Share, kFaceNodes>>, std::size_t> known;
  std::vector<std::vector<Index>> around;
  const auto add = [&](Index triangle, const std::array<double, 3>& place, double area) {
    const Part& part = part_[at(triangle)];
    double u = 0, v = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto uv = face_place(part.nodes, part.local[k]);
      u += place[k] * uv[0];
      v += place[k] * uv[1];
    }
    const FaceShape shape = face_shape(part.nodes, u, v);
    std::vector<std::pair<Index, double>> shares;
    for (std::size_t k = 0; k < part.nodes; ++k) {
      if (std::abs(shape.N[k]) > 1e-9) shares.emplace_back(part.face[k], shape.N[k]);
    }
    std::sort(shares.begin(), shares.end());
    SurfacePoint point;
    std::array<Share, kFaceNodes> name{};
    for (const auto& [node, weight] : shares) {
      name[point.nodes] = {node, std::lround(1e6 * weight)};
      point.node[point.nodes] = node;
      point.weight[point.nodes++] = weight;
    }
    point.side = side_[at(triangle)];
    point.sheet = sheet[at(triangle)];
    const auto [it, fresh] = known.emplace(std::pair(point.sheet, name), points_.size());
    if (fresh) {
      points_.push_back(point);
      around.emplace_back();
    }
    points_[it->second].area += area;
    around[it->second].push_back(triangle);
  };
  for (Index t = 0; t < triangles(); ++t) {
    const double area = norm(area_vector(corner_[at(t)], rest));
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<double, 3> corner{}, edge{};
      corner[k] = 1;
      edge[k] = edge[(k + 1) % 3] = 0.5;
      add(t, corner, at_corner * area);
      add(t, edge, at_edge * area);
    }
    add(t, {1.0 / 3, 1.0 / 3, 1.0 / 3}, at_middle * area);
  }
  for (const auto& list : around) at_point_.push(list);
}

bool ContactSurface::touches(Index triangle, const SurfacePoint& point) const {
  const Part& part = part_[at(triangle)];
  for (std::size_t c = 0; c < part.nodes; ++c) {
    for (std::size_t k = 0; k < point.nodes; ++k) {
      if (point.node[k] == part.face[c]) return true;
    }
  }
  return false;
}

bool ContactSurface::neighbors(Index t, Index other) const {
  const auto &a = corner_[at(t)], &b = corner_[at(other)];
  return std::any_of(a.begin(), a.end(),
                     [&](Index n) { return std::find(b.begin(), b.end(), n) != b.end(); });
}

bool ContactSurface::facing(Index s, Index triangle, std::span<const Vec3> x) const {
  Vec3 own{};
  for (const Index t : at_point_[s]) own += area_vector(corner_[at(t)], x);
  return face_each_other(area_vector(corner_[at(triangle)], x), own);
}

ContactSurface::Around ContactSurface::around(Index triangle, Index point) const {
  Around out;
  out.patch.margin = kLeave * size_;
  const Part& middle = part_[at(triangle)];
  const bool curved = middle.nodes > 3;
  if (curved) {
    out.patch.face = out.patch.nodes = static_cast<std::uint8_t>(middle.nodes);
    std::copy_n(middle.face.begin(), middle.nodes, out.node.begin());
  }
  const auto add = [&](Index t, bool side) {
    out.patch.side[out.patch.triangles] = side;
    auto& corner = out.patch.corner[out.patch.triangles++];
    for (std::size_t k = 0; k < 3; ++k) {
      const Index n = corner_[at(t)][k];
      std::uint8_t place = 0;
      while (place < out.patch.nodes && out.node[place] != n) ++place;
      if (place == out.patch.nodes) out.node[out.patch.nodes++] = n;
      corner[k] = place;
    }
  };
  add(triangle, false);
  for (const Index t : across_[at(triangle)]) {
    if (t >= 0 && !curved && !touches(t, points_[at(point)])) add(t, false);
  }
  for (const Index t : side_across_[at(triangle)]) {
    if (t >= 0 && !touches(t, points_[at(point)])) add(t, true);
  }
  return out;
}

bool ContactSurface::in_patch(Index center, Index triangle, Index point) const {
  if (center == triangle) return true;
  if (center < 0) return false;
  const auto& smooth = across_[at(center)];
  const auto& sides = side_across_[at(center)];
  if (part_[at(center)].nodes > 3 && part_[at(center)].face == part_[at(triangle)].face) return true;
  return ((part_[at(center)].nodes == 3 &&
           std::find(smooth.begin(), smooth.end(), triangle) != smooth.end()) ||
          std::find(sides.begin(), sides.end(), triangle) != sides.end()) &&
         !touches(triangle, points_[at(point)]);
}

ContactSurface::Candidate ContactSurface::candidate(Index t, Index s, Index center, const Vec3& p,
                                                    std::span<const Vec3> x) const {
  const auto& c = corner_[at(t)];
  const Vec3 &a = x[at(c[0])], &b = x[at(c[1])], &d = x[at(c[2])];
  const Vec3 normal = cross(b - a, d - a);
  const TrianglePoint near = nearest_on_triangle(p, a, b, d);
  const Vec3 r = p - (near.weight[0] * a + near.weight[1] * b + near.weight[2] * d);
  const double height = dot(r, normal) / norm(normal), square = dot(r, r);
  // Beyond a border nothing is below the point.
  const auto open = [&](int edge) {
    const auto k = static_cast<std::size_t>(edge);
    return across_[at(t)][k] < 0 && side_across_[at(t)][k] < 0;
  };
  bool border = near.edge >= 0 && open(near.edge);
  if (near.corner >= 0) {
    // A triangle that ends at a border with a corner alone does not see what is beside it: its neighbors
    // do.
    const auto k = static_cast<std::size_t>(near.corner), before = (k + 2) % 3;
    const bool inner = across_[at(t)][k] >= 0 && across_[at(t)][before] >= 0;
    border = open(near.corner) || open((near.corner + 2) % 3) || (inner && at_border_[at(c[k])]);
  }
  const double most = (in_patch(center, t, s) ? kLeave : kEnter) * size_;
  if (border && square - height * height > most * most) return Candidate{};
  return Candidate{t, square, height};
}

// Of triangles that share the nearest corner or edge, the one that the point is most above.
void ContactSurface::keep_nearer(Candidate& best, const Candidate& c) const {
  if (c.triangle < 0) return;
  const double same = 1e-9 * best.square + 1e-20 * size_ * size_;
  const double higher = std::abs(c.height) - std::abs(best.height);
  const bool equal = c.square <= best.square + same && best.triangle >= 0 &&
                     (higher > 1e-9 * size_ || (higher > -1e-9 * size_ && c.triangle < best.triangle));
  if (c.square < best.square - same || equal) best = c;
}

ContactSurface::Finding ContactSurface::find(Index s, std::span<const Vec3> from, std::span<const Vec3> x,
                                             double reach, Index center, std::span<const Box> boxes) const {
  const SurfacePoint& point = points_[at(s)];
  const auto other = static_cast<std::size_t>(single_ ? 0 : 1 - point.side);
  const Vec3 p0 = point.position(from), p1 = point.position(x);
  Box way(p0);
  way.add(p1);
  way = way.grown(reach);
  Vec3 own{};
  for (const Index t : at_point_[s]) own += area_vector(corner_[at(t)], x);
  // Within one body, what is behind a triangle may be the other side of its own wall: there depth counts only
  // next to where the point went in from the front.
  Index entered = -1;
  if (single_ && center >= 0) {
    const auto& c = corner_[at(center)];
    if (dot(area_vector(c, x), p1 - x[at(c[0])]) < 0) entered = center;
  }
  Finding found;
  Candidate best{-1, reach * reach, 0};
  double earliest = 2;
  const auto faces = [&](Index t) {
    const auto& c = corner_[at(t)];
    // Surfaces that touch face each other; what lies beside a point on its own surface does not.
    return face_each_other(area_vector(c, x), own) && !(single_ && touches(t, point));
  };
  const auto enter = [&](const Box& box) { return box.meets(way); };
  tree_[other].visit(boxes, enter, [&](Index i) {
    const Index t = first_[other] + i;
    if (!faces(t)) return;
    const Candidate c = candidate(t, s, center, p1, x);
    if (!single_ || c.height > -kShallow * size_ || (entered >= 0 && neighbors(t, entered)))
      keep_nearer(best, c);
    const auto& corner = corner_[at(t)];
    const double time = crossing_time({p0, from[at(corner[0])], from[at(corner[1])], from[at(corner[2])]},
                                      {p1, x[at(corner[0])], x[at(corner[1])], x[at(corner[2])]});
    if (time < earliest || (time <= 1 && time == earliest && t < found.crossed)) {
      earliest = time;
      found.crossed = t;
    }
  });
  if (single_ && found.crossed >= 0) {
    tree_[other].visit(boxes, enter, [&](Index i) {
      if (neighbors(i, found.crossed) && faces(i)) keep_nearer(best, candidate(i, s, center, p1, x));
    });
  }
  found.nearest = best.triangle;
  found.distance = best.height < 0 ? -std::sqrt(best.square) : std::sqrt(best.square);
  return found;
}

void ContactSurface::search(std::span<const Vec3> from, std::span<const Vec3> x, double reach,
                            std::span<const Index> center, const Parallel* parallel,
                            std::span<Finding> out) const {
  std::array<std::vector<Box>, 2> boxes;
  for (std::size_t side = 0; side < 2; ++side) {
    boxes[side] = tree_[side].fitted([&](Index i) {
      const auto& c = corner_[at(first_[side] + i)];
      Box box(x[at(c[0])]);
      for (const Index n : c) {
        box.add(x[at(n)]);
        box.add(from[at(n)]);
      }
      return box;
    });
  }
  const auto look = [&](Index begin, Index end) {
    for (Index s = begin; s < end; ++s) {
      const auto other = static_cast<std::size_t>(single_ ? 0 : 1 - points_[at(s)].side);
      out[at(s)] = find(s, from, x, reach, center[at(s)], boxes[other]);
    }
  };
  const auto count = static_cast<Index>(points_.size());
  if (parallel)
    parallel->run(count, 128, look);
  else
    look(0, count);
}

}  // namespace isochor
