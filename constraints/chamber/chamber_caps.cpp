#include "constraints/chamber/chamber_caps.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace isochor {

void add_cap(EnclosedVolumePool& pool, std::vector<Index> loop, std::span<const Vec3> rest, bool curved) {
  const std::size_t stride = curved ? 2 : 1, corners = loop.size() / stride;
  std::size_t apex = 0;
  for (std::size_t i = 1; i < corners; ++i) {
    const Vec3 &a = rest[at(loop[i * stride])], &b = rest[at(loop[apex * stride])];
    if (std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z}) apex = i;
  }
  std::rotate(loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(apex * stride), loop.end());
  const auto corner = [&](std::size_t i) { return loop[(i % corners) * stride]; };
  const auto middle = [&](std::size_t i) { return loop[(i % corners) * stride + 1]; };
  if (!curved) {
    for (std::size_t i = 1; i + 1 < corners; ++i) {
      const Index tri[3] = {corner(0), corner(i), corner(i + 1)};
      pool.add_face(tri, triangle3_rule());
    }
    return;
  }
  // The fan meets the two edges at its apex along their chords; their bulges are added apart.
  for (std::size_t i = 1; i + 1 < corners; ++i) {
    const Index cap[4] = {corner(0), corner(i), corner(i + 1), middle(i)};
    pool.add_face(cap, cap4_rule());
  }
  for (const std::size_t i : {std::size_t{0}, corners - 1}) {
    const Index bulge[3] = {corner(i), corner(i + 1), middle(i)};
    pool.add_face(bulge, bulge3_rule());
  }
}

bool SymmetryCaps::planar(const std::vector<Index>& loop) const {
  const auto rest = builder_.rest();
  Vec3 normal{};
  const Vec3 o = rest[at(loop[0])];
  for (std::size_t i = 0; i < loop.size(); ++i) {
    normal += cross(rest[at(loop[i])] - o, rest[at(loop[(i + 1) % loop.size()])] - o);
  }
  const double size = std::sqrt(dot(normal, normal));
  return size == 0 || std::all_of(loop.begin(), loop.end(), [&](Index n) {
           return std::abs(dot(normal, rest[at(n)] - o)) <= 1e-7 * length_ * size;
         });
}

bool SymmetryCaps::add_loop(const std::vector<Index>& loop, std::size_t stride) {
  std::vector<std::size_t> planes;
  for (std::size_t i = 0; i < loop.size(); i += stride) {
    const Index a = loop[i], b = loop[(i + stride) % loop.size()];
    const auto plane = plane_of(a, b, stride == 2 ? loop[i + 1] : a);
    if (!plane) return false;
    planes.push_back(*plane);
  }
  loops_.push_back({loop, stride, std::move(planes)});
  return true;
}

Vec3 SymmetryCaps::place(const Vec3& start) {
  std::vector<std::size_t> active;
  for (std::size_t k = 0; k < planes_.size() && active.size() < 3; ++k) {
    Vec3 n = planes_[k].normal;
    for (const std::size_t j : active) n -= dot(n, frame_[j]) * frame_[j];
    frame_.resize(planes_.size());
    if (dot(n, n) < 1e-12) continue;
    frame_[k] = (1 / std::sqrt(dot(n, n))) * n;
    active.push_back(k);
  }
  const auto project = [&](Vec3 x, std::size_t dependent) {
    // Few planes, any angles: alternate until all hold.
    for (int sweep = 0; sweep < 200; ++sweep) {
      for (const std::size_t k : active) {
        const bool parallel = std::abs(dot(planes_[k].normal, planes_[dependent].normal)) > 1 - 1e-9;
        const Plane& p = planes_[parallel ? dependent : k];
        x -= (dot(p.normal, x) - p.offset) * p.normal;
      }
    }
    return x;
  };
  const Vec3 origin = planes_.empty() ? start : project(start, active[0]);
  for (std::size_t k = 0; k < planes_.size(); ++k) {
    planes_[k].apex = on(k, origin) ? origin : project(origin, k);
  }
  return origin;
}

bool SymmetryCaps::fits(const Vec3& origin) const {
  for (const Loop& loop : loops_) {
    for (std::size_t e = 0; e < loop.planes.size(); ++e) {
      const std::size_t k = loop.planes[e], l = loop.planes[(e + 1) % loop.planes.size()];
      if (k == l || planes_[k].apex == planes_[l].apex) continue;
      if (!(on(k, origin) && on(k, planes_[l].apex)) && !(on(l, origin) && on(l, planes_[k].apex)))
        return false;
    }
  }
  return true;
}

void SymmetryCaps::add_to(EnclosedVolumePool& pool, const Vec3& origin) const {
  for (const Loop& loop : loops_) {
    for (std::size_t e = 0; e < loop.planes.size(); ++e) {
      const Plane& plane = planes_[loop.planes[e]];
      if (plane.apex == origin) continue;
      const std::size_t i = e * loop.stride;
      const Index edge[3] = {loop.nodes[i], loop.nodes[(i + loop.stride) % loop.nodes.size()],
                             loop.nodes[(i + 1) % loop.nodes.size()]};
      const bool curved = loop.stride == 2;
      pool.add_face(std::span(edge, curved ? 3 : 2), curved ? fan3_rule() : fan2_rule(), plane.apex);
    }
  }
}

bool SymmetryCaps::on(std::size_t k, const Vec3& x) const {
  return std::abs(dot(planes_[k].normal, x) - planes_[k].offset) <= 1e-7 * length_;
}

std::optional<std::size_t> SymmetryCaps::plane_of(Index a, Index b, Index middle) {
  const auto rest = builder_.rest();
  std::optional<Vec3> found;
  for (const Vec3& n : builder_.directions_given(a)) {
    const auto of_b = builder_.directions_given(b);
    const bool shared =
        std::any_of(of_b.begin(), of_b.end(), [&](const Vec3& m) { return std::abs(dot(n, m)) > 1 - 1e-9; });
    if (!shared || std::abs(dot(n, rest[at(b)] - rest[at(a)])) > 1e-7 * length_ ||
        std::abs(dot(n, rest[at(middle)] - rest[at(a)])) > 1e-7 * length_) {
      continue;
    }
    for (std::size_t k = 0; k < planes_.size(); ++k) {
      if (std::abs(dot(planes_[k].normal, n)) > 1 - 1e-9 && on(k, rest[at(a)])) return k;
    }
    found = n;
  }
  if (!found) return std::nullopt;
  planes_.push_back({*found, dot(*found, rest[at(a)]), {}});
  return planes_.size() - 1;
}

}  // namespace isochor
