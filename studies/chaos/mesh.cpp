#include "studies/chaos/mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <span>

#include "isochor/generate.h"

namespace isochor::studies {

namespace {

using Counts = std::array<int, 3>;

// Kuhn's six tets of a block, corners by bits: 1 along x, 2 along y, 4 along z.
constexpr int kTets[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                             {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
constexpr int kHex[8] = {0, 1, 3, 2, 4, 5, 7, 6};
constexpr int kHexSides[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                 {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
constexpr int kTetSides[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
constexpr int kTet10Edges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};

double six_volumes(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return dot(b - a, cross(c - a, d - a));
}

// A grid of blocks, some of them missing.
class Grid {
 public:
  Grid(const ChaosMeshKind& kind, ChaosRandom& random) : kind_(kind), random_(random) {
    choose_counts();
    solid_.assign(static_cast<std::size_t>(n_[0] * n_[1] * n_[2]), true);
    cut();
  }
  ChaosMesh make();

 private:
  void choose_counts();
  void cut();
  std::vector<double> lines(int axis);
  void place_nodes();
  void add_cells();
  void add_regions();
  void jitter();
  void taper();
  void add_surfaces(ChaosMesh& out) const;
  std::string side_name(const std::vector<Index>& face) const;
  bool cell_is_good(std::size_t cell) const;

  std::size_t block(int i, int j, int k) const {
    return static_cast<std::size_t>(i + n_[0] * (j + n_[1] * k));
  }
  int point(int i, int j, int k) const { return i + (n_[0] + 1) * (j + (n_[1] + 1) * k); }

  const ChaosMeshKind& kind_;
  ChaosRandom& random_;
  Counts n_{1, 1, 1};
  std::vector<bool> solid_;
  bool chamber_ = false;
  Mesh mesh_;
  std::vector<Counts> at_;  // place of each node in the grid
  std::vector<int> cell_block_;
};

void Grid::choose_counts() {
  const int blocks = std::max(1, kind_.largest_cells / (kind_.cell_type == CellType::hex8 ? 1 : 6));
  const int least = kind_.chamber ? 3 : 1;
  const int most = kind_.chamber ? 4 : 6;
  n_ = {least, least, least};
  for (int tries = 0; tries < 12; ++tries) {
    const auto axis = static_cast<std::size_t>(random_.whole(0, 2));
    Counts larger = n_;
    ++larger[axis];
    if (larger[axis] <= most && larger[0] * larger[1] * larger[2] <= blocks) n_ = larger;
  }
}

void Grid::cut() {
  if (kind_.chamber) {
    chamber_ = true;
    // A closed chamber, or one that is open at a side.
    const bool open = random_.chance(0.3);
    // Blocks left standing in it, so that its walls meet at edges of four faces.
    const bool ragged = random_.chance(0.3);
    for (int k = 1; k < n_[2] - 1; ++k) {
      for (int j = 1; j < n_[1] - 1; ++j) {
        for (int i = 1; i < n_[0] - (open ? 0 : 1); ++i)
          solid_[block(i, j, k)] = ragged && !(i == 1 && j == 1 && k == 1) && random_.chance(0.4);
      }
    }
    return;
  }
  if (!random_.chance(0.25)) return;
  // Notches: a corner or an edge of blocks goes.
  const int across = random_.whole(0, 1);
  for (int k = 0; k < n_[2]; ++k) {
    for (int j = 0; j < n_[1]; ++j) {
      for (int i = 0; i < n_[0]; ++i) {
        if (i >= n_[0] / 2 && j >= (n_[1] + 1) / 2 && (across == 0 || k >= (n_[2] + 1) / 2))
          solid_[block(i, j, k)] = false;
      }
    }
  }
}

// Where the planes of the grid lie along an axis: even, graded or with one layer pressed flat.
std::vector<double> Grid::lines(int axis) {
  const int n = n_[static_cast<std::size_t>(axis)];
  std::vector<double> width(static_cast<std::size_t>(n), 1);
  const int kind = random_.whole(0, 7);
  if (kind == 0) {
    const double ratio = random_.between(1.2, 4);
    for (std::size_t i = 1; i < width.size(); ++i) width[i] = width[i - 1] * ratio;
  }
  if (kind == 1 && n > 1) width[static_cast<std::size_t>(random_.whole(0, n - 1))] = random_.decades(-4, -1);
  double total = 0;
  for (const double w : width) total += w;
  std::vector<double> at(1, 0);
  double sum = 0;
  for (const double w : width) {
    sum += w;
    at.push_back(kind_.size[axis] * (sum / total));
  }
  at.back() = kind_.size[axis];
  return at;
}

void Grid::place_nodes() {
  const std::vector<double> x = lines(0), y = lines(1), z = lines(2);
  std::vector<Index> number(static_cast<std::size_t>((n_[0] + 1) * (n_[1] + 1) * (n_[2] + 1)), -1);
  for (int k = 0; k < n_[2]; ++k) {
    for (int j = 0; j < n_[1]; ++j) {
      for (int i = 0; i < n_[0]; ++i) {
        if (!solid_[block(i, j, k)]) continue;
        for (int c = 0; c < 8; ++c) {
          const Counts p{i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)};
          Index& id = number[static_cast<std::size_t>(point(p[0], p[1], p[2]))];
          if (id >= 0) continue;
          id = mesh_.node_count();
          at_.push_back(p);
          mesh_.nodes.push_back({x[static_cast<std::size_t>(p[0])], y[static_cast<std::size_t>(p[1])],
                                 z[static_cast<std::size_t>(p[2])]});
        }
      }
    }
  }
}

void Grid::add_cells() {
  std::map<Counts, Index> number;
  for (std::size_t a = 0; a < at_.size(); ++a) number[at_[a]] = static_cast<Index>(a);
  const bool hexahedra = kind_.cell_type == CellType::hex8;
  mesh_.cell_type = hexahedra ? CellType::hex8 : CellType::tet4;
  for (int k = 0; k < n_[2]; ++k) {
    for (int j = 0; j < n_[1]; ++j) {
      for (int i = 0; i < n_[0]; ++i) {
        if (!solid_[block(i, j, k)]) continue;
        const auto node = [&](int corner) {
          return number[Counts{i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2)}];
        };
        if (hexahedra) {
          for (const int c : kHex) mesh_.cells.push_back(node(c));
          cell_block_.push_back(static_cast<int>(block(i, j, k)));
          continue;
        }
        for (const auto& tet : kTets) {
          for (const int c : tet) mesh_.cells.push_back(node(c));
          cell_block_.push_back(static_cast<int>(block(i, j, k)));
        }
      }
    }
  }
}

void Grid::add_regions() {
  mesh_.regions = {"body"};
  const int regions = random_.pick({1, 1, 1, 2, 2, 3});
  if (regions == 1) return;
  mesh_.regions = {"one", "two", "three"};
  mesh_.regions.resize(static_cast<std::size_t>(regions));
  const int kind = random_.whole(0, 2);  // slabs, blocks at random, cells at random
  std::vector<Index> of_block;
  for (std::size_t b = 0; b < solid_.size(); ++b) {
    const int i = static_cast<int>(b) % n_[0];
    of_block.push_back(static_cast<Index>(kind == 0 ? i * regions / n_[0] : random_.whole(0, regions - 1)));
  }
  for (const int b : cell_block_) {
    mesh_.cell_region.push_back(kind == 2 ? static_cast<Index>(random_.whole(0, regions - 1))
                                          : of_block[static_cast<std::size_t>(b)]);
  }
  // Each region has a cell, whatever was drawn.
  for (int r = 0; r < regions && static_cast<std::size_t>(r) < mesh_.cell_region.size(); ++r)
    mesh_.cell_region[static_cast<std::size_t>(r)] = static_cast<Index>(r);
}

bool Grid::cell_is_good(std::size_t cell) const {
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh_.cell_type));
  const auto x = [&](int a) {
    return mesh_.nodes[static_cast<std::size_t>(mesh_.cells[cell * per + static_cast<std::size_t>(a)])];
  };
  constexpr double least = 1e-7;
  const double whole = kind_.size.x * kind_.size.y * kind_.size.z / static_cast<double>(cell_block_.size());
  if (per == 4) return six_volumes(x(0), x(1), x(2), x(3)) > least * whole;
  constexpr int kCorners[8][4] = {{0, 1, 3, 4}, {1, 2, 0, 5}, {2, 3, 1, 6}, {3, 0, 2, 7},
                                  {4, 7, 5, 0}, {5, 4, 6, 1}, {6, 5, 7, 2}, {7, 6, 4, 3}};
  return std::all_of(std::begin(kCorners), std::end(kCorners), [&](const auto& c) {
    return six_volumes(x(c[0]), x(c[1]), x(c[2]), x(c[3])) > 0.02 * whole;
  });
}

// Moves nodes as far as their cells allow; those on a side of the block stay in it.
void Grid::jitter() {
  const double share = random_.pick({0.0, 0.1, 0.3, 0.6});
  if (share == 0) return;
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh_.cell_type));
  std::vector<std::vector<std::size_t>> cells_at(mesh_.nodes.size());
  for (std::size_t a = 0; a < mesh_.cells.size(); ++a)
    cells_at[static_cast<std::size_t>(mesh_.cells[a])].push_back(a / per);
  for (std::size_t a = 0; a < mesh_.nodes.size(); ++a) {
    const Vec3 before = mesh_.nodes[a];
    Vec3 move{};
    for (int axis = 0; axis < 3; ++axis) {
      const int n = n_[static_cast<std::size_t>(axis)], p = at_[a][static_cast<std::size_t>(axis)];
      const double drawn = random_.between(-1, 1);
      if (p > 0 && p < n) move[axis] = share * (kind_.size[axis] / n) * drawn;
    }
    for (int tries = 0; tries < 6; ++tries) {
      mesh_.nodes[a] = before + move;
      const bool good =
          std::all_of(cells_at[a].begin(), cells_at[a].end(), [&](std::size_t c) { return cell_is_good(c); });
      if (good) break;
      move = 0.5 * move;
      mesh_.nodes[a] = before;
    }
  }
}

// Linear along x: one end gets thinner and the block leans over.
void Grid::taper() {
  if (!random_.chance(0.2)) return;
  const double end = random_.between(0.2, 1.5), lean = random_.between(-0.5, 0.5);
  for (Vec3& x : mesh_.nodes) {
    const double s = x.x / kind_.size.x;
    x = {x.x, x.y * (1 + (end - 1) * s), x.z * (1 + (end - 1) * s) + lean * kind_.size.z * s};
  }
}

std::string Grid::side_name(const std::vector<Index>& face) const {
  static const char* const names[3][2] = {{"x0", "x1"}, {"y0", "y1"}, {"z0", "z1"}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int end : {0, 1}) {
      const int plane = end == 0 ? 0 : n_[axis];
      const bool all = std::all_of(face.begin(), face.end(),
                                   [&](Index a) { return at_[static_cast<std::size_t>(a)][axis] == plane; });
      if (all) return names[axis][end];
    }
  }
  return chamber_ ? "chamber" : "notch";
}

void Grid::add_surfaces(ChaosMesh& out) const {
  const bool hexahedra = mesh_.cell_type == CellType::hex8;
  const std::size_t per = hexahedra ? 8 : 4;
  std::map<std::vector<Index>, std::pair<int, std::vector<Index>>> sides;
  for (std::size_t c = 0; c < mesh_.cells.size(); c += per) {
    for (int s = 0; s < (hexahedra ? 6 : 4); ++s) {
      std::vector<Index> face;
      for (int k = 0; k < (hexahedra ? 4 : 3); ++k)
        face.push_back(
            mesh_.cells[c + static_cast<std::size_t>(hexahedra ? kHexSides[s][k] : kTetSides[s][k])]);
      std::vector<Index> key = face;
      std::sort(key.begin(), key.end());
      auto& entry = sides[key];
      ++entry.first;
      entry.second = face;
    }
  }
  std::map<std::string, std::vector<Index>> named;
  for (const auto& [key, entry] : sides) {
    if (entry.first != 1) continue;
    auto& faces = named[side_name(entry.second)];
    faces.insert(faces.end(), entry.second.begin(), entry.second.end());
  }
  for (auto& [name, faces] : named) {
    out.surfaces.push_back(name);
    out.mesh.surfaces.push_back({name, std::move(faces)});
  }
}

// Bends the edges of cells of ten nodes, by less than what would fold the flattest cell at each.
void bend(Mesh& mesh, std::size_t corners, ChaosRandom& random) {
  if (!random.chance(0.5)) return;
  const double share = random.between(0, 0.2);
  std::vector<double> room(mesh.nodes.size(), HUGE_VAL);
  for (std::size_t c = 0; c < mesh.cells.size(); c += 10) {
    const auto x = [&](std::size_t a) { return mesh.nodes[static_cast<std::size_t>(mesh.cells[c + a])]; };
    double longest = 0;
    for (const auto& e : kTet10Edges) {
      const Vec3 d = x(static_cast<std::size_t>(e[1])) - x(static_cast<std::size_t>(e[0]));
      longest = std::max(longest, dot(d, d));
    }
    const double height = six_volumes(x(0), x(1), x(2), x(3)) / longest;
    for (std::size_t e = 4; e < 10; ++e) {
      double& least = room[static_cast<std::size_t>(mesh.cells[c + e])];
      least = std::min(least, height);
    }
  }
  for (std::size_t a = corners; a < mesh.nodes.size(); ++a)
    mesh.nodes[a] += (share * room[a]) * random.direction();
}

ChaosMesh Grid::make() {
  place_nodes();
  add_cells();
  add_regions();
  jitter();
  taper();
  ChaosMesh out;
  out.mesh = mesh_;
  out.chamber = chamber_;
  add_surfaces(out);
  if (kind_.cell_type == CellType::tet10) {
    out.mesh = to_tet10(out.mesh);
    bend(out.mesh, mesh_.nodes.size(), random_);
  }
  return out;
}

// Numbers of cells and faces in a Gmsh file, and the order of nodes where it is another one.
struct GmshShape {
  int cell, face;
};
GmshShape gmsh_shape(CellType type) {
  if (type == CellType::tet4) return {4, 2};
  return type == CellType::tet10 ? GmshShape{11, 9} : GmshShape{5, 3};
}

}  // namespace

ChaosMesh chaos_mesh(const ChaosMeshKind& kind, ChaosRandom& random) {
  return Grid(kind, random).make();
}

std::string gmsh_text(const Mesh& mesh) {
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n";
  const auto add = [&text](const auto&... parts) { ((text += parts), ...); };
  add(std::to_string(mesh.surfaces.size() + mesh.regions.size()), "\n");
  for (std::size_t s = 0; s < mesh.surfaces.size(); ++s)
    add("2 ", std::to_string(s + 1), " \"", mesh.surfaces[s].name, "\"\n");
  for (std::size_t r = 0; r < mesh.regions.size(); ++r)
    add("3 ", std::to_string(101 + r), " \"", mesh.regions[r], "\"\n");
  add("$EndPhysicalNames\n$Nodes\n", std::to_string(mesh.nodes.size()), "\n");
  for (std::size_t a = 0; a < mesh.nodes.size(); ++a) {
    char line[120];
    const Vec3& x = mesh.nodes[a];
    std::snprintf(line, sizeof line, "%zu %.17g %.17g %.17g\n", a + 1, x.x, x.y, x.z);
    text += line;
  }
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type)),
             face = static_cast<std::size_t>(nodes_per_face(mesh.cell_type));
  std::string elements;
  std::size_t count = 0;
  const auto element = [&](int type, std::size_t group, std::span<const Index> nodes) {
    elements += std::to_string(++count) + " " + std::to_string(type) + " 2 " + std::to_string(group) + " " +
                std::to_string(group);
    std::vector<Index> order(nodes.begin(), nodes.end());
    if (order.size() == 10) std::swap(order[8], order[9]);  // Gmsh has the edges (23) and (13) this way round
    for (const Index a : order) elements += " " + std::to_string(a + 1);
    elements += "\n";
  };
  for (std::size_t s = 0; s < mesh.surfaces.size(); ++s) {
    const auto& faces = mesh.surfaces[s].faces;
    for (std::size_t f = 0; f + face <= faces.size(); f += face)
      element(gmsh_shape(mesh.cell_type).face, s + 1, std::span(faces).subspan(f, face));
  }
  for (std::size_t c = 0; c + per <= mesh.cells.size(); c += per) {
    const std::size_t region =
        mesh.cell_region.empty() ? 0 : static_cast<std::size_t>(mesh.cell_region[c / per]);
    element(gmsh_shape(mesh.cell_type).cell, 101 + region, std::span(mesh.cells).subspan(c, per));
  }
  add("$EndNodes\n$Elements\n", std::to_string(count), "\n", elements, "$EndElements\n");
  return text;
}

}  // namespace isochor::studies
