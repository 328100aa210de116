#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <unordered_map>

#include "engine/math/triangle.h"
#include "engine/mesh/check/check_parts.h"
#include "isochor/mesh_select.h"

namespace isochor {

namespace {

using mesh_files::at;
using mesh_files::CellFace;
using mesh_files::FaceCorners;
using mesh_files::join;
using mesh_files::length;

bool measurable(const Vec3& v) {
  return std::isfinite(dot(v, v));
}
bool finite_direction(const Vec3& v) {
  return measurable(v) && dot(v, v) > 0;
}

double diagonal(const std::vector<Vec3>& points) {
  if (points.empty()) return 0;
  Vec3 low = points[0], high = low;
  for (const Vec3& p : points) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  return length(high - low);
}

double distance_to_triangle(const Vec3& y, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto& w = nearest_on_triangle(y, a, b, c).weight;
  return length(y - (w[0] * a + w[1] * b + w[2] * c));
}

// Whether points are near a triangle surface, by the triangles in the cell of a grid that they fall into.
class NearSurface {
 public:
  NearSurface(const TriangleSurface& surface, double reach)
      : surface_(surface),
        reach_(reach),
        size_(std::max({diagonal(surface.points) / 64, 2 * reach, std::numeric_limits<double>::min()})) {
    for (std::size_t t = 0; t < surface.triangles.size(); t += 3) {
      Place low{}, high{};
      for (int k = 0; k < 3; ++k) {
        const double a = point(t)[k], b = point(t + 1)[k], c = point(t + 2)[k];
        low[at(k)] = place(std::min({a, b, c}) - reach);
        high[at(k)] = place(std::max({a, b, c}) + reach);
      }
      for (std::int64_t i = low[0]; i <= high[0]; ++i) {
        for (std::int64_t j = low[1]; j <= high[1]; ++j) {
          for (std::int64_t k = low[2]; k <= high[2]; ++k) cells_[key({i, j, k})].push_back(t);
        }
      }
    }
  }

  bool has(const Vec3& x, double within) const {
    const auto found = cells_.find(key({place(x.x), place(x.y), place(x.z)}));
    if (found == cells_.end()) return false;
    return std::any_of(found->second.begin(), found->second.end(), [&](std::size_t t) {
      return distance_to_triangle(x, point(t), point(t + 1), point(t + 2)) <= std::min(within, reach_);
    });
  }

 private:
  using Place = std::array<std::int64_t, 3>;
  const Vec3& point(std::size_t corner) const { return surface_.points[at(surface_.triangles[corner])]; }
  // Far beyond any surface the place no longer counts, and the cast is safe.
  std::int64_t place(double x) const {
    return static_cast<std::int64_t>(std::floor(std::clamp(x / size_, -1e15, 1e15)));
  }
  static std::uint64_t key(const Place& p) {
    std::uint64_t hash = 0;
    for (const std::int64_t i : p) {
      hash = (hash ^ static_cast<std::uint64_t>(i)) * 0x9E3779B97F4A7C15ull;
      hash ^= hash >> 29;
    }
    return hash;
  }

  const TriangleSurface& surface_;
  double reach_, size_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> cells_;
};

// A boundary face with what the criteria ask of it.
struct Face {
  std::vector<Index> nodes;  // as MeshSurface has them
  FaceCorners key{};         // corners, sorted
  Vec3 center{}, normal{};   // normal of unit length, zero for a face without area
  double size = 0;           // longest side [m]
};

class Selector {
 public:
  Selector(const Mesh& mesh, const MeshSelection& selection)
      : mesh_(mesh),
        wanted_(selection),
        tolerance_(selection.tolerance > 0 ? selection.tolerance : 1e-5 * diagonal(mesh.nodes)) {}

  Result<void> check();
  Result<std::vector<Index>> faces();
  Result<std::vector<Index>> nodes();

 private:
  std::string who() const { return "selection \"" + wanted_.name + "\": "; }
  Error nothing(const char* what) const {
    return Error{who() + "no " + what + " of the mesh fits all that is asked for (nodes may be " +
                 join(tolerance_) + " m off); correct the place, or give a larger tolerance"};
  }
  bool fits(const Vec3& x) const;
  bool fits(const Face& face) const;
  std::vector<Face> boundary() const;
  // Faces of the named surfaces by their sorted corners.
  Result<std::set<FaceCorners>> named() const;
  std::vector<Face> grown(std::vector<Face> candidates) const;

  const Mesh& mesh_;
  const MeshSelection& wanted_;
  double tolerance_;
  std::optional<NearSurface> near_;
};

Result<void> Selector::check() {
  const MeshSelection& s = wanted_;
  MeshReport report;
  if (!mesh_files::check_arrays(mesh_, report)) return Error{who() + report.findings.front().message};
  if (!(s.tolerance >= 0) || !std::isfinite(s.tolerance))
    return Error{who() + "tolerance = " + join(s.tolerance) + " m; it must be zero or positive"};
  if (s.box && !(measurable((*s.box)[0]) && measurable((*s.box)[1])))
    return Error{who() + "the box has a coordinate that is no finite number"};
  for (int k = 0; s.box && k < 3; ++k) {
    if ((*s.box)[0][k] <= (*s.box)[1][k]) continue;
    return Error{who() + "the box runs from " + join((*s.box)[0][k]) + " to " + join((*s.box)[1][k]) +
                 " m along " + "xyz"[k] + "; give the lower corner first"};
  }
  if (s.plane && !(measurable(s.plane->point) && finite_direction(s.plane->normal)))
    return Error{who() + "the plane needs a finite point and a normal that is not zero"};
  if (s.sphere && !(measurable(s.sphere->center) && s.sphere->radius > 0 && std::isfinite(s.sphere->radius)))
    return Error{who() + "the sphere's radius is " + join(s.sphere->radius) +
                 " m; give it a finite center and a positive radius"};
  const auto bad_angle = [](double angle) { return !(angle > 0) || angle > std::numbers::pi; };
  if (s.facing && (!finite_direction(s.facing->direction) || bad_angle(s.facing->angle)))
    return Error{who() + "facing has the angle " + join(s.facing->angle) +
                 " rad; give a direction that is not zero and an angle above 0 and up to pi"};
  if (s.seed && (!measurable(s.seed->point) || bad_angle(s.seed->angle)))
    return Error{who() + "the seed has the angle " + join(s.seed->angle) +
                 " rad; give a finite point and an angle above 0 and up to pi"};
  if (!s.box && !s.plane && !s.sphere && !s.lies_on && !s.facing && !s.seed && s.of.empty())
    return Error{who() + "nothing says what it holds; give a box, plane, sphere, facing, seed, file or of"};
  // Nodes and the middles of faces, which may be off by more.
  if (s.lies_on) near_.emplace(*s.lies_on, std::max(tolerance_, 0.01 * diagonal(mesh_.nodes)));
  return {};
}

bool Selector::fits(const Vec3& x) const {
  const MeshSelection& s = wanted_;
  for (int k = 0; s.box && k < 3; ++k) {
    if (x[k] < (*s.box)[0][k] - tolerance_ || x[k] > (*s.box)[1][k] + tolerance_) return false;
  }
  if (s.plane && std::abs(dot(s.plane->normal, x - s.plane->point)) > tolerance_ * length(s.plane->normal))
    return false;
  if (s.sphere && length(x - s.sphere->center) > s.sphere->radius + tolerance_) return false;
  return !near_ || near_->has(x, tolerance_);
}

bool Selector::fits(const Face& face) const {
  for (const Index n : face.nodes) {
    if (!fits(mesh_.nodes[at(n)])) return false;
  }
  // A face that bridges a notch has all its nodes on the surface; one that is coarser than it sags a little.
  if (near_ && !near_->has(face.center, tolerance_ + 0.1 * face.size)) return false;
  if (!wanted_.facing) return true;
  const Vec3& d = wanted_.facing->direction;
  return dot(face.normal, d) >= (std::cos(wanted_.facing->angle) - 1e-12) * length(d);
}

std::vector<Face> Selector::boundary() const {
  const std::vector<CellFace> all = mesh_files::sorted_cell_faces(mesh_);
  std::vector<Face> faces;
  for (std::size_t first = 0, last = 0; first < all.size(); first = last) {
    while (last < all.size() && all[last].corners == all[first].corners) ++last;
    if (last - first != 1) continue;
    Face face;
    mesh_files::append_face(mesh_, all[first], face.nodes);
    face.key = all[first].corners;
    const std::size_t corners = face.key[0] < 0 ? 3 : 4;
    const auto x = [&](std::size_t k) { return mesh_.nodes[at(face.nodes[k % corners])]; };
    for (std::size_t k = 0; k < corners; ++k) {
      face.center += (1.0 / static_cast<double>(corners)) * x(k);
      face.size = std::max(face.size, length(x(k + 1) - x(k)));
    }
    const Vec3 n = corners == 3 ? cross(x(1) - x(0), x(2) - x(0)) : cross(x(2) - x(0), x(3) - x(1));
    if (length(n) > 0) face.normal = (1 / length(n)) * n;
    faces.push_back(std::move(face));
  }
  return faces;
}

Result<std::set<FaceCorners>> Selector::named() const {
  std::set<FaceCorners> keys;
  const auto width = static_cast<std::size_t>(nodes_per_face(mesh_.cell_type));
  const auto add = [&](const MeshSurface& surface) {
    for (std::size_t f = 0; f + width <= surface.faces.size(); f += width) {
      FaceCorners key{-1, -1, -1, -1};
      std::copy_n(&surface.faces[f], width == 4 ? 4 : 3, key.begin());
      std::sort(key.begin(), key.end());
      keys.insert(key);
    }
  };
  std::optional<MeshReport> report;
  for (const std::string& name : wanted_.of) {
    const auto own = std::find_if(mesh_.surfaces.begin(), mesh_.surfaces.end(),
                                  [&](const MeshSurface& s) { return s.name == name; });
    if (own != mesh_.surfaces.end()) {
      add(*own);
      continue;
    }
    if (!report) report = check_mesh(mesh_);
    const auto part = std::find_if(report->boundary.begin(), report->boundary.end(),
                                   [&](const BoundaryPart& p) { return p.surface.name == name; });
    if (part == report->boundary.end()) {
      std::string known;
      for (const MeshSurface& s : mesh_.surfaces) known += (known.empty() ? "\"" : ", \"") + s.name + "\"";
      for (const BoundaryPart& p : report->boundary) {
        if (!p.taken) known += (known.empty() ? "\"" : ", \"") + p.surface.name + "\"";
      }
      return Error{who() + "the mesh has no surface named \"" + name + "\"; it has " + known};
    }
    add(part->surface);
  }
  return keys;
}

// The candidates that hang together with the one nearest to the seed.
std::vector<Face> Selector::grown(std::vector<Face> candidates) const {
  const auto corners = [](const Face& f) { return f.key[0] < 0 ? std::size_t{3} : std::size_t{4}; };
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> at_edge;
  const auto edge = [&](const Face& f, std::size_t k) {
    const auto [a, b] = std::minmax(f.nodes[k], f.nodes[(k + 1) % corners(f)]);
    return (static_cast<std::uint64_t>(a) << 32) | static_cast<std::uint32_t>(b);
  };
  std::size_t nearest = 0;
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < candidates.size(); ++f) {
    const Face& face = candidates[f];
    for (std::size_t k = 0; k < corners(face); ++k) at_edge[edge(face, k)].push_back(f);
    for (std::size_t k = 2; k < corners(face); ++k) {
      const double d =
          distance_to_triangle(wanted_.seed->point, mesh_.nodes[at(face.nodes[0])],
                               mesh_.nodes[at(face.nodes[k - 1])], mesh_.nodes[at(face.nodes[k])]);
      if (d < best) {
        best = d;
        nearest = f;
      }
    }
  }
  const double least = std::cos(wanted_.seed->angle);
  std::vector<bool> in(candidates.size(), false);
  std::vector<std::size_t> front = {nearest};
  in[nearest] = true;
  while (!front.empty()) {
    const Face& face = candidates[front.back()];
    front.pop_back();
    for (std::size_t k = 0; k < corners(face); ++k) {
      for (const std::size_t next : at_edge[edge(face, k)]) {
        if (in[next] || dot(face.normal, candidates[next].normal) < least) continue;
        in[next] = true;
        front.push_back(next);
      }
    }
  }
  std::vector<Face> out;
  for (std::size_t f = 0; f < candidates.size(); ++f) {
    if (in[f]) out.push_back(std::move(candidates[f]));
  }
  return out;
}

Result<std::vector<Index>> Selector::faces() {
  std::vector<Face> candidates = boundary();
  if (!wanted_.of.empty()) {
    auto keys = named();
    if (!keys) return keys.failure();
    std::erase_if(candidates, [&](const Face& f) { return keys.value().count(f.key) == 0; });
  }
  std::erase_if(candidates, [&](const Face& f) { return !fits(f); });
  if (candidates.empty()) return nothing("boundary face");
  if (wanted_.seed) candidates = grown(std::move(candidates));
  std::vector<Index> out;
  for (const Face& f : candidates) out.insert(out.end(), f.nodes.begin(), f.nodes.end());
  return out;
}

Result<std::vector<Index>> Selector::nodes() {
  std::vector<Index> out;
  if (!wanted_.of.empty() || wanted_.facing || wanted_.seed) {
    auto on_faces = faces();
    if (!on_faces) return on_faces;
    out = std::move(on_faces).value();
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }
  for (Index n = 0; n < mesh_.node_count(); ++n) {
    if (fits(mesh_.nodes[at(n)])) out.push_back(n);
  }
  if (out.empty()) return nothing("node");
  return out;
}

}  // namespace

Result<std::vector<Index>> select_faces(const Mesh& mesh, const MeshSelection& selection) {
  Selector selector(mesh, selection);
  if (auto r = selector.check(); !r) return r.failure();
  return selector.faces();
}

Result<std::vector<Index>> select_nodes(const Mesh& mesh, const MeshSelection& selection) {
  Selector selector(mesh, selection);
  if (auto r = selector.check(); !r) return r.failure();
  return selector.nodes();
}

Result<void> add_surface(Mesh& mesh, const MeshSelection& selection) {
  for (const MeshSurface& s : mesh.surfaces) {
    if (s.name == selection.name)
      return Error{"selection \"" + s.name + "\": the mesh has a surface of this name; take another"};
  }
  auto faces = select_faces(mesh, selection);
  if (!faces) return faces.failure();
  mesh.surfaces.push_back({selection.name, std::move(faces).value()});
  return {};
}

Result<void> add_node_set(Mesh& mesh, const MeshSelection& selection) {
  for (const MeshNodeSet& s : mesh.node_sets) {
    if (s.name == selection.name)
      return Error{"selection \"" + s.name + "\": the mesh has a node set of this name; take another"};
  }
  auto nodes = select_nodes(mesh, selection);
  if (!nodes) return nodes.failure();
  mesh.node_sets.push_back({selection.name, std::move(nodes).value()});
  return {};
}

}  // namespace isochor
