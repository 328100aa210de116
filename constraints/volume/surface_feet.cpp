// The way from the inside of a mesh to its surface: a smooth distance, its gradient, paths along it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "engine/base/base.h"
#include "engine/mesh/cell_shape.h"
#include "isochor/painted.h"

namespace isochor {

namespace {

using Corners = std::array<Index, 4>;
using Triangle = std::array<Index, 3>;

constexpr std::array<std::array<std::size_t, 3>, 4> kFaces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

Triangle sorted(Triangle t) {
  std::sort(t.begin(), t.end());
  return t;
}

// Six tets of a hexahedron whose face diagonals start at the smallest node number, so that neighbors agree.
std::vector<Corners> split(std::span<const Index> hex) {
  const Index apex = *std::min_element(hex.begin(), hex.end());
  std::vector<Corners> out;
  for (const auto& side : kHexShape.side) {
    std::array<Index, 4> q{};
    for (std::size_t k = 0; k < 4; ++k) q[k] = hex[side[k]];
    if (std::find(q.begin(), q.end(), apex) != q.end()) continue;
    const auto first = static_cast<std::size_t>(std::min_element(q.begin(), q.end()) - q.begin());
    for (const std::size_t k : {1u, 2u})
      out.push_back({apex, q[first], q[(first + k) % 4], q[(first + k + 1) % 4]});
  }
  return out;
}

// The mesh as linear tets, with what paths need.
class Tets {
 public:
  explicit Tets(const Mesh& mesh) : x_(mesh.nodes) {
    const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
    for (std::size_t c = 0; c < at(mesh.cell_count()); ++c) {
      const std::span<const Index> cell(mesh.cells.data() + c * per, per);
      first_.push_back(static_cast<Index>(tet_.size()));
      if (mesh.cell_type == CellType::hex8) {
        for (const Corners& t : split(cell)) add(t);
      } else {
        add({cell[0], cell[1], cell[2], cell[3]});
      }
    }
    std::map<Triangle, std::pair<std::size_t, std::size_t>> open;
    neighbor_.assign(tet_.size(), {-1, -1, -1, -1});
    for (std::size_t t = 0; t < tet_.size(); ++t) {
      for (std::size_t f = 0; f < 4; ++f) {
        const auto [it, fresh] = open.emplace(sorted(face(t, f)), std::pair(t, f));
        if (fresh) continue;
        neighbor_[t][f] = static_cast<Index>(it->second.first);
        neighbor_[it->second.first][it->second.second] = static_cast<Index>(t);
      }
    }
  }

  std::size_t size() const { return tet_.size(); }
  const Corners& operator[](std::size_t t) const { return tet_[t]; }
  std::size_t first_of(Index cell) const { return at(first_[at(cell)]); }
  std::size_t end_of(Index cell) const {
    return at(cell) + 1 < first_.size() ? at(first_[at(cell) + 1]) : tet_.size();
  }
  // The tet of a cell that holds a point, and where in it.
  std::pair<std::size_t, std::array<double, 4>> locate(Index cell, const Vec3& p) const {
    std::pair<std::size_t, std::array<double, 4>> best{first_of(cell), {}};
    double innermost = -std::numeric_limits<double>::infinity();
    for (std::size_t t = first_of(cell); t < end_of(cell); ++t) {
      std::array<double, 4> b{};
      for (std::size_t a = 0; a < 4; ++a) b[a] = dot(slope_[t][a], p - x_[at(tet_[t][(a + 1) % 4])]);
      const double least = *std::min_element(b.begin(), b.end());
      if (least <= innermost) continue;
      innermost = least;
      best = {t, b};
    }
    double sum = 0;
    for (double& b : best.second) sum += b = std::max(0.0, b);
    for (double& b : best.second) b /= sum;
    return best;
  }
  Index neighbor(std::size_t t, std::size_t f) const { return neighbor_[t][f]; }
  double volume(std::size_t t) const { return volume_[t]; }
  const Vec3& slope(std::size_t t, std::size_t a) const { return slope_[t][a]; }  // of barycentric a [1/m]
  Triangle face(std::size_t t, std::size_t f) const {
    return {tet_[t][kFaces[f][0]], tet_[t][kFaces[f][1]], tet_[t][kFaces[f][2]]};
  }

 private:
  void add(const Corners& t) {
    const Vec3 a = x_[at(t[0])], b = x_[at(t[1])] - a, c = x_[at(t[2])] - a, d = x_[at(t[3])] - a;
    const double six = dot(cross(b, c), d);
    if (six == 0 || !std::isfinite(six)) return;  // flat: no path leads through it
    std::array<Vec3, 4> s{{{}, (1 / six) * cross(c, d), (1 / six) * cross(d, b), (1 / six) * cross(b, c)}};
    s[0] = -(s[1] + s[2] + s[3]);
    tet_.push_back(t);
    slope_.push_back(s);
    volume_.push_back(std::abs(six) / 6);
  }

  const std::vector<Vec3>& x_;
  std::vector<Corners> tet_;
  std::vector<std::array<Vec3, 4>> slope_;
  std::vector<double> volume_;
  std::vector<std::array<Index, 4>> neighbor_;
  std::vector<Index> first_;
};

// -laplace u = 1, u = 0 where `surface`, natural elsewhere: conjugate gradients, scaled by the diagonal.
// Fixed order of sums, so that zones are the same on every run.
std::vector<double> depth_potential(const Tets& tets, const std::vector<bool>& surface) {
  const std::size_t n = surface.size();
  std::vector<double> u(n, 0), r(n, 0), diagonal(n, 0), z(n), p(n), q(n);
  for (std::size_t t = 0; t < tets.size(); ++t) {
    for (std::size_t a = 0; a < 4; ++a) {
      const std::size_t i = at(tets[t][a]);
      if (!surface[i]) r[i] += tets.volume(t) / 4;
      diagonal[i] += tets.volume(t) * dot(tets.slope(t, a), tets.slope(t, a));
    }
  }
  const auto product = [&](const std::vector<double>& v, std::vector<double>& out) {
    std::fill(out.begin(), out.end(), 0.0);
    for (std::size_t t = 0; t < tets.size(); ++t) {
      Vec3 g;
      for (std::size_t a = 0; a < 4; ++a) g += v[at(tets[t][a])] * tets.slope(t, a);
      for (std::size_t a = 0; a < 4; ++a) {
        const std::size_t i = at(tets[t][a]);
        if (!surface[i]) out[i] += tets.volume(t) * dot(g, tets.slope(t, a));
      }
    }
  };
  const auto scaled = [&](const std::vector<double>& v, std::vector<double>& out) {
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
      out[i] = diagonal[i] > 0 ? v[i] / diagonal[i] : 0;
      sum += out[i] * v[i];
    }
    return sum;
  };
  double rz = scaled(r, z);
  const double goal = 1e-20 * rz;
  p = z;
  for (std::size_t k = 0; k < 10 * n + 100 && rz > goal; ++k) {
    product(p, q);
    double pq = 0;
    for (std::size_t i = 0; i < n; ++i) pq += p[i] * q[i];
    if (!(pq > 0)) break;
    const double step = rz / pq;
    for (std::size_t i = 0; i < n; ++i) {
      u[i] += step * p[i];
      r[i] -= step * q[i];
    }
    const double next = scaled(r, z);
    for (std::size_t i = 0; i < n; ++i) p[i] = z[i] + next / rz * p[i];
    rz = next;
  }
  return u;
}

// Gradients at nodes: means over the tets around, so that paths bend smoothly.
std::vector<Vec3> nodal_gradient(const Tets& tets, const std::vector<double>& u) {
  std::vector<Vec3> g(u.size());
  std::vector<double> volume(u.size(), 0);
  for (std::size_t t = 0; t < tets.size(); ++t) {
    Vec3 own;
    for (std::size_t a = 0; a < 4; ++a) own += u[at(tets[t][a])] * tets.slope(t, a);
    for (std::size_t a = 0; a < 4; ++a) {
      g[at(tets[t][a])] += tets.volume(t) * own;
      volume[at(tets[t][a])] += tets.volume(t);
    }
  }
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (volume[i] > 0) g[i] = (1 / volume[i]) * g[i];
  }
  return g;
}

// Walks from a point in a tet against the gradient until it leaves through the surface. At faces that must
// not be passed, the rest of the boundary and the face it just came through, it slides. False: it got stuck.
class Path {
 public:
  Path(const Tets& tets, const std::vector<Vec3>& gradient, const std::set<Triangle>& surface)
      : tets_(tets), gradient_(gradient), surface_(surface) {}

  // `start`: barycentric coordinates in the tet.
  bool follow(std::size_t tet, const std::array<double, 4>& start, SurfaceFoot& foot) {
    b_ = start;
    Index from = -1;
    constexpr int kMostTets = 5000;
    for (int step = 0; step < kMostTets; ++step) {
      std::size_t exit = 4;
      if (!cross_tet(tet, from, exit)) return false;
      const Triangle face = tets_.face(tet, exit);
      const Index next = tets_.neighbor(tet, exit);
      if (next < 0) {
        for (std::size_t k = 0; k < 3; ++k) {
          foot.node[k] = face[k];
          foot.weight[k] = b_[kFaces[exit][k]];
        }
        return true;
      }
      std::array<double, 4> b{};
      for (std::size_t a = 0; a < 4; ++a) {
        for (std::size_t k = 0; k < 4; ++k) {
          if (tets_[at(next)][a] == tets_[tet][k]) b[a] = b_[k];
        }
      }
      b_ = b;
      from = static_cast<Index>(tet);
      tet = at(next);
    }
    return false;
  }

 private:
  // Moves b_ to where the path leaves the tet.
  bool cross_tet(std::size_t tet, Index from, std::size_t& exit) {
    std::array<bool, 4> wall{};
    for (int slides = 0; slides < 12; ++slides) {
      Vec3 way;
      for (std::size_t a = 0; a < 4; ++a) way -= b_[a] * gradient_[at(tets_[tet][a])];
      const double strength = dot(way, way);
      remove_walls(tet, wall, way);
      if (!(dot(way, way) > 1e-12 * strength) || !(strength > 0)) return false;
      double reach = std::numeric_limits<double>::infinity();
      for (std::size_t a = 0; a < 4; ++a) {
        const double rate = dot(tets_.slope(tet, a), way);
        if (wall[a] || rate >= 0) continue;
        if (std::max(0.0, b_[a]) / -rate < reach) {
          reach = std::max(0.0, b_[a]) / -rate;
          exit = a;
        }
      }
      if (!std::isfinite(reach)) return false;
      double sum = 0;
      for (std::size_t a = 0; a < 4; ++a) {
        b_[a] = a == exit ? 0 : std::max(0.0, b_[a] + reach * dot(tets_.slope(tet, a), way));
        sum += b_[a];
      }
      for (double& b : b_) b /= sum;
      const Index next = tets_.neighbor(tet, exit);
      const bool back = next >= 0 && next == from && reach == 0;
      const bool closed = next < 0 && !surface_.count(sorted(tets_.face(tet, exit)));
      if (!back && !closed) return true;
      wall[exit] = true;
    }
    return false;
  }

  void remove_walls(std::size_t tet, const std::array<bool, 4>& wall, Vec3& way) const {
    std::vector<Vec3> frame;
    for (std::size_t a = 0; a < 4; ++a) {
      if (!wall[a] || b_[a] > 0) continue;
      Vec3 n = tets_.slope(tet, a);
      const double size = dot(n, n);
      for (const Vec3& f : frame) n -= dot(n, f) * f;
      if (!(dot(n, n) > 1e-12 * size)) continue;
      frame.push_back((1 / std::sqrt(dot(n, n))) * n);
      way -= dot(way, frame.back()) * frame.back();
    }
  }

  const Tets& tets_;
  const std::vector<Vec3>& gradient_;
  const std::set<Triangle>& surface_;
  std::array<double, 4> b_{};
};

Vec3 center_of(const Mesh& mesh, Index cell) {
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  const std::size_t corners = cell_shape(mesh.cell_type).corners;
  Vec3 center;
  for (std::size_t k = 0; k < corners; ++k)
    center += (1.0 / static_cast<double>(corners)) * mesh.nodes[at(mesh.cells[at(cell) * per + k])];
  return center;
}

// Corners of the named faces, sorted; hexahedra have four.
Result<std::set<std::vector<Index>>> named_faces(const Mesh& mesh, std::span<const std::string> surfaces) {
  std::set<std::vector<Index>> out;
  const auto width = static_cast<std::size_t>(nodes_per_face(mesh.cell_type));
  const std::size_t corners = cell_shape(mesh.cell_type).side_corners;
  for (const std::string& name : surfaces) {
    const auto it = std::find_if(mesh.surfaces.begin(), mesh.surfaces.end(),
                                 [&](const MeshSurface& s) { return s.name == name; });
    if (it == mesh.surfaces.end() || it->faces.empty()) {
      std::string known;
      for (const MeshSurface& s : mesh.surfaces) known += (known.empty() ? "\"" : ", \"") + s.name + "\"";
      return Error{"the mesh has no surface \"" + name + "\" with faces; it has " +
                   (known.empty() ? "none" : known)};
    }
    for (std::size_t f = 0; f + width <= it->faces.size(); f += width) {
      std::vector<Index> face(it->faces.begin() + static_cast<std::ptrdiff_t>(f),
                              it->faces.begin() + static_cast<std::ptrdiff_t>(f + corners));
      std::sort(face.begin(), face.end());
      out.insert(std::move(face));
    }
  }
  return out;
}

}  // namespace

Result<SurfaceFeet> surface_feet(const Mesh& mesh, std::span<const std::string> surfaces) {
  auto named = named_faces(mesh, surfaces);
  if (!named) return named.failure();
  const Tets tets(mesh);
  if (tets.size() < at(mesh.cell_count())) {
    return Error{"the mesh has cells without volume; repair it ('isochor check' names them)"};
  }
  // A triangle of a named quadrangle has all its corners in it.
  const auto is_named = [&](const Triangle& t, Index cell) {
    const CellShape& shape = cell_shape(mesh.cell_type);
    const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
    for (std::size_t s = 0; s < shape.sides; ++s) {
      std::vector<Index> side;
      for (std::size_t k = 0; k < shape.side_corners; ++k)
        side.push_back(mesh.cells[at(cell) * per + shape.side[s][k]]);
      std::sort(side.begin(), side.end());
      if (std::includes(side.begin(), side.end(), t.begin(), t.end()) && named.value().count(side))
        return true;
    }
    return false;
  };
  std::set<Triangle> surface;
  std::vector<bool> on_surface(mesh.nodes.size(), false);
  for (Index c = 0; c < mesh.cell_count(); ++c) {
    for (std::size_t t = tets.first_of(c); t < tets.end_of(c); ++t) {
      for (std::size_t f = 0; f < 4; ++f) {
        if (tets.neighbor(t, f) >= 0) continue;
        const Triangle face = sorted(tets.face(t, f));
        if (!surfaces.empty() && !is_named(face, c)) continue;
        surface.insert(face);
        for (const Index n : face) on_surface[at(n)] = true;
      }
    }
  }
  if (surface.empty()) {
    return Error{"none of the surfaces lies on the boundary of the mesh; name one that does"};
  }
  const std::vector<double> u = depth_potential(tets, on_surface);
  const std::vector<Vec3> gradient = nodal_gradient(tets, u);
  SurfaceFeet out;
  out.depth.resize(u.size());
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double slope = std::sqrt(dot(gradient[i], gradient[i]));
    out.depth[i] = on_surface[i] ? 0 : std::sqrt(slope * slope + 2 * std::max(0.0, u[i])) - slope;
  }
  Path path(tets, gradient, surface);
  for (Index c = 0; c < mesh.cell_count(); ++c) {
    const Vec3 center = center_of(mesh, c);
    const auto [t, start] = tets.locate(c, center);
    SurfaceFoot foot;
    if (!path.follow(t, start, foot)) {
      ++out.lost;
      double best = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < on_surface.size(); ++i) {
        if (!on_surface[i]) continue;
        const Vec3 d = mesh.nodes[i] - center;
        if (dot(d, d) < best) {
          best = dot(d, d);
          foot.node.fill(static_cast<Index>(i));
        }
      }
      foot.weight = {1, 0, 0};
    }
    out.cell.push_back(foot);
  }
  return out;
}

}  // namespace isochor
