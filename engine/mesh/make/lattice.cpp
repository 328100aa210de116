#include "isochor/lattice.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/base/base.h"
#include "engine/mesh/cell_shape.h"
#include "engine/mesh/check/check_parts.h"

namespace isochor {

namespace {

using mesh_files::Groups;
using mesh_files::join;

Result<void> check(const LatticeDef& def) {
  if (!(def.spacing > 0) || !std::isfinite(def.spacing))
    return Error{join("lattice: spacing = ", def.spacing, " m; give the edge of a cube, a positive number")};
  if (def.samples < 1 || def.samples > 32)
    return Error{join("lattice: samples = ", def.samples, "; give a number from 1 to 32")};
  if (def.triangles.empty() || def.triangles.size() % 3 != 0) {
    return Error{join("lattice: triangles has ", def.triangles.size(),
                      " entries; give three points for each triangle, at least four triangles")};
  }
  for (std::size_t i = 0; i < def.points.size(); ++i) {
    const Vec3& x = def.points[i];
    if (!std::isfinite(x.x) || !std::isfinite(x.y) || !std::isfinite(x.z))
      return Error{join("lattice: point ", i, " is not finite; repair the surface")};
  }
  std::map<std::pair<Index, Index>, int> directed;
  for (std::size_t t = 0; t < def.triangles.size(); t += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = def.triangles[t + k], b = def.triangles[t + (k + 1) % 3];
      if (a < 0 || at(a) >= def.points.size()) {
        return Error{join("lattice: triangle ", t / 3, " names point ", a, " of ", def.points.size(),
                          " points; correct the indices")};
      }
      ++directed[{a, b}];
    }
  }
  std::size_t open = 0;
  for (const auto& [edge, count] : directed) {
    const auto back = directed.find({edge.second, edge.first});
    if (back == directed.end() || back->second != count) ++open;
  }
  if (open > 0) {
    return Error{join(
        "lattice: the surface is not closed, or its triangles do not all run the same way around: ", open,
        " edges have no partner; close it, and merge points that lie on each other")};
  }
  return {};
}

// The box of the surface in cubes, and each cube in parts.
class Grid {
 public:
  explicit Grid(const LatticeDef& def) : samples_(def.samples), cube_(def.spacing) {
    Vec3 low = def.points[at(def.triangles[0])], high = low;
    for (const Index n : def.triangles) {
      for (int k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], def.points[at(n)][k]);
        high[k] = std::max(high[k], def.points[at(n)][k]);
      }
    }
    for (int k = 0; k < 3; ++k) {
      // A surface that fills whole cubes gets just these; the lattice sits in the middle otherwise.
      count_[static_cast<std::size_t>(k)] = std::max(1.0, std::ceil((high[k] - low[k]) / cube_ - 1e-9));
      origin_[k] = 0.5 * (low[k] + high[k] - count_[static_cast<std::size_t>(k)] * cube_);
    }
  }
  double parts() const { return count_[0] * count_[1] * count_[2] * std::pow(samples_, 3); }
  Index cubes(int axis) const { return static_cast<Index>(count_[static_cast<std::size_t>(axis)]); }
  Index fine(int axis) const { return cubes(axis) * samples_; }
  double part() const { return cube_ / samples_; }
  const Vec3& origin() const { return origin_; }

  std::size_t number(Index i, Index j, Index k) const {
    return at(i) + at(fine(0)) * (at(j) + at(fine(1)) * at(k));
  }
  std::size_t cube_number(Index i, Index j, Index k) const {
    return at(i) + at(cubes(0)) * (at(j) + at(cubes(1)) * at(k));
  }
  // The part that holds a point, within the grid.
  std::array<Index, 3> part_of(const Vec3& x) const {
    std::array<Index, 3> p{};
    for (int k = 0; k < 3; ++k) {
      const auto place = static_cast<Index>(std::floor((x[k] - origin_[k]) / part()));
      p[static_cast<std::size_t>(k)] = std::clamp<Index>(place, 0, fine(k) - 1);
    }
    return p;
  }
  int samples() const { return samples_; }
  double cube() const { return cube_; }

 private:
  int samples_;
  double cube_;
  Vec3 origin_{};
  std::array<double, 3> count_{};
};

// Parts whose middle is inside: crossings of the surface with a line along z through each column, in pairs.
void mark_inside(const LatticeDef& def, const Grid& grid, std::vector<bool>& marked) {
  std::vector<std::vector<double>> crossing(at(grid.fine(0)) * at(grid.fine(1)));
  // Lines a little off the middle, so that they meet no edge of a surface made of round numbers.
  const double off_x = 0.5 + 1.23e-4, off_y = 0.5 - 2.71e-4;
  for (std::size_t t = 0; t < def.triangles.size(); t += 3) {
    Vec3 x[3];
    for (std::size_t k = 0; k < 3; ++k)
      x[k] = (1 / grid.part()) * (def.points[at(def.triangles[t + k])] - grid.origin());
    const double area = (x[1].x - x[0].x) * (x[2].y - x[0].y) - (x[2].x - x[0].x) * (x[1].y - x[0].y);
    if (area == 0) continue;
    const auto range = [](double a, double b, double c, double off, Index count) {
      const double low = std::min({a, b, c}) - off, high = std::max({a, b, c}) - off;
      return std::pair(std::max<Index>(0, static_cast<Index>(std::ceil(low))),
                       std::min<Index>(count - 1, static_cast<Index>(std::floor(high))));
    };
    const auto [i0, i1] = range(x[0].x, x[1].x, x[2].x, off_x, grid.fine(0));
    const auto [j0, j1] = range(x[0].y, x[1].y, x[2].y, off_y, grid.fine(1));
    for (Index j = j0; j <= j1; ++j) {
      for (Index i = i0; i <= i1; ++i) {
        const double u = i + off_x, v = j + off_y;
        const auto side = [&](const Vec3& a, const Vec3& b) {
          return ((b.x - a.x) * (v - a.y) - (u - a.x) * (b.y - a.y)) / area;
        };
        const double l0 = side(x[1], x[2]), l1 = side(x[2], x[0]), l2 = side(x[0], x[1]);
        if (l0 < 0 || l1 < 0 || l2 < 0) continue;
        crossing[at(i) + at(grid.fine(0)) * at(j)].push_back(l0 * x[0].z + l1 * x[1].z + l2 * x[2].z);
      }
    }
  }
  for (Index j = 0; j < grid.fine(1); ++j) {
    for (Index i = 0; i < grid.fine(0); ++i) {
      auto& z = crossing[at(i) + at(grid.fine(0)) * at(j)];
      std::sort(z.begin(), z.end());
      for (std::size_t c = 0; c + 1 < z.size(); c += 2) {
        for (Index k = std::max<Index>(0, static_cast<Index>(std::ceil(z[c] - 0.5)));
             k < grid.fine(2) && k + 0.5 < z[c + 1]; ++k) {
          marked[grid.number(i, j, k)] = true;
        }
      }
    }
  }
}

// Parts that the surface passes through. What only touches a part from outside does not count: points are
// pulled inside by a hair.
void mark_surface(const LatticeDef& def, const Grid& grid, std::vector<bool>& marked) {
  for (std::size_t t = 0; t < def.triangles.size(); t += 3) {
    const Vec3 a = def.points[at(def.triangles[t])];
    const Vec3 u = def.points[at(def.triangles[t + 1])] - a, v = def.points[at(def.triangles[t + 2])] - a;
    const Vec3 normal = cross(u, v);
    const double size = std::sqrt(dot(normal, normal));
    const Vec3 inward = size > 0 ? (-1e-6 * grid.part() / size) * normal : Vec3{};
    const double longest = std::sqrt(std::max({dot(u, u), dot(v, v), dot(u - v, u - v)}));
    const int steps = 1 + static_cast<int>(std::ceil(2 * longest / grid.part()));
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        const auto [x, y, z] = grid.part_of(a + inward + (1.0 * i / steps) * u + (1.0 * j / steps) * v);
        marked[grid.number(x, y, z)] = true;
      }
    }
  }
}

double signed_volume(const LatticeDef& def) {
  double volume = 0;
  for (std::size_t t = 0; t < def.triangles.size(); t += 3) {
    const Vec3 o = def.points[at(def.triangles[0])];
    const Vec3 a = def.points[at(def.triangles[t])] - o, b = def.points[at(def.triangles[t + 1])] - o;
    volume += dot(a, cross(b, def.points[at(def.triangles[t + 2])] - o)) / 6;
  }
  return volume;
}

// Marked parts joined within their cubes; a cell for each group. Returns the cell of every part, -1: none.
std::vector<Index> cells_of_parts(const LatticeDef& def, const Grid& grid, const std::vector<bool>& marked,
                                  std::vector<std::array<Index, 3>>& cube_of_cell) {
  Groups groups(marked.size());
  const std::size_t step[3] = {1, at(grid.fine(0)), at(grid.fine(0)) * at(grid.fine(1))};
  const Index s = grid.samples();
  std::vector<std::size_t> first_of_cube(
      def.keep_apart ? 0 : at(grid.cubes(0)) * at(grid.cubes(1)) * at(grid.cubes(2)), marked.size());
  const auto each = [&](auto&& visit) {
    for (Index k = 0; k < grid.fine(2); ++k) {
      for (Index j = 0; j < grid.fine(1); ++j) {
        for (Index i = 0; i < grid.fine(0); ++i) {
          const std::size_t n = grid.number(i, j, k);
          if (marked[n]) visit(n, std::array<Index, 3>{i, j, k});
        }
      }
    }
  };
  each([&](std::size_t n, const std::array<Index, 3>& place) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const bool same_cube = (place[axis] + 1) % s != 0;
      if (same_cube && marked[n + step[axis]])
        groups.join(static_cast<Index>(n), static_cast<Index>(n + step[axis]));
    }
    if (!def.keep_apart) {
      std::size_t& first = first_of_cube[grid.cube_number(place[0] / s, place[1] / s, place[2] / s)];
      if (first == marked.size()) first = n;
      groups.join(static_cast<Index>(first), static_cast<Index>(n));
    }
  });
  std::vector<Index> cell(marked.size(), -1);
  each([&](std::size_t n, const std::array<Index, 3>& place) {
    Index& leader = cell[at(groups.root(static_cast<Index>(n)))];
    if (leader < 0) {
      leader = static_cast<Index>(cube_of_cell.size());
      cube_of_cell.push_back({place[0] / s, place[1] / s, place[2] / s});
    }
    cell[n] = leader;
  });
  return cell;
}

// Every cell starts with eight corners of its own. Cells whose parts touch through the face between their
// cubes share the four corners of that face.
void join_corners(const Grid& grid, const std::vector<Index>& cell, Groups& corners) {
  const std::size_t step[3] = {1, at(grid.fine(0)), at(grid.fine(0)) * at(grid.fine(1))};
  constexpr std::size_t low_side[3] = {0, 2, 4};  // of kHexShape, towards smaller x, y, z
  for (Index k = 0; k < grid.fine(2); ++k) {
    for (Index j = 0; j < grid.fine(1); ++j) {
      for (Index i = 0; i < grid.fine(0); ++i) {
        const std::size_t n = grid.number(i, j, k);
        const Index place[3] = {i, j, k};
        for (int axis = 0; axis < 3; ++axis) {
          if (place[axis] + 1 == grid.fine(axis) || (place[axis] + 1) % grid.samples() != 0) continue;
          const Index here = cell[n], next = cell[n + step[axis]];
          if (here < 0 || next < 0) continue;
          for (const std::size_t low : kHexShape.side[low_side[axis]]) {
            // The corner across: the sign along the axis turned.
            auto sign = kHexSign[low];
            sign[static_cast<std::size_t>(axis)] = 1;
            const auto across =
                static_cast<Index>(std::find(kHexSign.begin(), kHexSign.end(), sign) - kHexSign.begin());
            corners.join(8 * here + across, 8 * next + static_cast<Index>(low));
          }
        }
      }
    }
  }
}

// Cells at the cubes, with the corners that these share; returns the cell of each cube.
std::vector<Index> add_cells(const Grid& grid, const std::vector<std::array<Index, 3>>& cube, Groups& corners,
                             Mesh& mesh) {
  mesh.cell_type = CellType::hex8;
  mesh.source = "lattice";
  mesh.regions = {"body"};
  std::vector<Index> node(8 * cube.size(), -1);
  // Two cells that came to share all their corners are one.
  std::map<std::array<Index, 8>, Index> known;
  std::vector<Index> place(cube.size());
  for (std::size_t c = 0; c < cube.size(); ++c) {
    std::array<Index, 8> n{};
    for (std::size_t a = 0; a < 8; ++a) {
      Index& number = node[at(corners.root(static_cast<Index>(8 * c + a)))];
      if (number < 0) {
        number = mesh.node_count();
        Vec3 x = grid.origin();
        for (int k = 0; k < 3; ++k) {
          const auto axis = static_cast<std::size_t>(k);
          x[k] += grid.cube() * (cube[c][axis] + (kHexSign[a][axis] + 1) / 2);
        }
        mesh.nodes.push_back(x);
      }
      n[a] = number;
    }
    const auto [it, fresh] = known.try_emplace(n, mesh.cell_count());
    place[c] = it->second;
    if (fresh) mesh.cells.insert(mesh.cells.end(), n.begin(), n.end());
  }
  return place;
}

// Points sit in the cell of a triangle's part there, found as the surface was marked.
Result<void> embed_points(const LatticeDef& def, const Grid& grid, const std::vector<Index>& cell,
                          const std::vector<Index>& place, const std::vector<std::array<Index, 3>>& cube,
                          Lattice& lattice) {
  lattice.embedding.resize(def.points.size());
  for (std::size_t t = 0; t < def.triangles.size(); t += 3) {
    const Vec3 a = def.points[at(def.triangles[t])];
    const Vec3 normal =
        cross(def.points[at(def.triangles[t + 1])] - a, def.points[at(def.triangles[t + 2])] - a);
    const double size = std::sqrt(dot(normal, normal));
    const Vec3 inward = size > 0 ? (-1e-6 * grid.part() / size) * normal : Vec3{};
    for (std::size_t k = 0; k < 3; ++k) {
      EmbeddedPoint& p = lattice.embedding[at(def.triangles[t + k])];
      if (p.cell >= 0) continue;
      const Vec3& x = def.points[at(def.triangles[t + k])];
      const auto [i, j, l] = grid.part_of(x + inward);
      const Index of = cell[grid.number(i, j, l)];
      if (of < 0) continue;
      p.cell = place[at(of)];
      Vec3 xi{};
      for (int axis = 0; axis < 3; ++axis) {
        xi[axis] = 2 * ((x[axis] - grid.origin()[axis]) / grid.cube() -
                        cube[at(of)][static_cast<std::size_t>(axis)]) -
                   1;
      }
      for (std::size_t c = 0; c < 8; ++c) {
        p.nodes[c] = lattice.mesh.cells[8 * at(p.cell) + c];
        p.weights[c] = hex_function(c, xi);
      }
    }
  }
  for (std::size_t i = 0; i < def.points.size(); ++i) {
    if (lattice.embedding[i].cell >= 0) continue;
    return Error{join("lattice: point ", i, " of the surface belongs to no triangle; remove it")};
  }
  return {};
}

}  // namespace

Result<Lattice> lattice_mesh(const LatticeDef& given) {
  if (auto r = check(given); !r) return r.failure();
  LatticeDef def = given;
  if (signed_volume(def) < 0) {
    for (std::size_t t = 0; t < def.triangles.size(); t += 3)
      std::swap(def.triangles[t], def.triangles[t + 1]);
  }
  const Grid grid(def);
  if (grid.parts() > 1e8) {
    return Error{join("lattice: spacing = ", def.spacing, " m with samples = ", def.samples, " makes ",
                      grid.parts(),
                      " parts and at most 1e8 are taken; use a wider spacing or fewer samples")};
  }
  std::vector<bool> marked(static_cast<std::size_t>(grid.parts()), false);
  mark_inside(def, grid, marked);
  mark_surface(def, grid, marked);
  std::vector<std::array<Index, 3>> cube;
  const std::vector<Index> cell = cells_of_parts(def, grid, marked, cube);
  Groups corners(8 * cube.size());
  join_corners(grid, cell, corners);

  Lattice lattice;
  const std::vector<Index> place = add_cells(grid, cube, corners, lattice.mesh);
  if (auto r = embed_points(def, grid, cell, place, cube, lattice); !r) return r.failure();
  return lattice;
}

std::vector<Vec3> embedded_surface(const Lattice& lattice, std::span<const Vec3> positions) {
  std::vector<Vec3> x(lattice.embedding.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const EmbeddedPoint& p = lattice.embedding[i];
    for (std::size_t a = 0; a < 8; ++a) x[i] += p.weights[a] * positions[at(p.nodes[a])];
  }
  return x;
}

}  // namespace isochor
