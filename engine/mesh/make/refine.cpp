// Uniform refinement: every cell into eight of its own shape.
//
// 1. A template says for each shape which points its eight children have, and how each follows from the nodes
//    of the parent: by its shape functions, so that curved edges are followed and nothing is left to a
//    special case.
// 2. A point is known by the corners that it lies between, counted as often as their barycentric coordinates
//    say. Neighbors find each other's points by this, whatever the order of their nodes.
// 3. Named surfaces, node sets and fields follow from the points.
#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "engine/base/available_memory.h"
#include "engine/base/base.h"
#include "engine/mesh/cell_shape.h"
#include "engine/mesh/words.h"
#include "isochor/generate.h"

namespace isochor {

namespace {

using mesh_files::join;
using mesh_files::quoted;

constexpr int kMostLevels = 8;

// Corners that a point lies between, ascending. Of triangles and tets each stands in here as often as four
// times its barycentric coordinate; of quadrangles and hexahedra the ends of an edge twice, those of a face
// once.
using Key = std::array<Index, 4>;

struct KeyHash {
  std::size_t operator()(const Key& key) const {
    std::uint64_t h = 0;
    for (const Index i : key) h = (h ^ static_cast<std::uint64_t>(i)) * 0x9e3779b97f4a7c15ull + (h >> 29);
    return static_cast<std::size_t>(h ^ (h >> 32));
  }
};

using Barycentric = std::array<int, 4>;  // in quarters

// A point of the children: a node of the parent, or the sum of nodes of the parent by weights.
struct Point {
  int node = -1;  // of the parent; -1: a new one
  std::array<int, 4> corner{};
  bool shared = true;  // with cells that have the same corners
  std::vector<std::pair<std::size_t, double>> weights;
};

struct Template {
  std::vector<Point> points;
  std::vector<std::size_t> children;  // points, the nodes of one child after another
};

std::array<int, 4> corners_of(const Barycentric& b) {
  std::array<int, 4> out{};
  std::size_t n = 0;
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < b[static_cast<std::size_t>(i)]; ++k) out[n++] = i;
  }
  return out;
}

// Shape functions of the tet at a point, linear or quadratic; zeros are left out.
std::vector<std::pair<std::size_t, double>> tet_weights(const Barycentric& b, bool quadratic) {
  std::vector<std::pair<std::size_t, double>> out;
  const auto add = [&](std::size_t node, double weight) {
    if (weight != 0) out.emplace_back(node, weight);
  };
  for (std::size_t i = 0; i < 4; ++i) {
    const double l = 0.25 * b[i];
    add(i, quadratic ? l * (2 * l - 1) : l);
  }
  for (std::size_t e = 0; quadratic && e < 6; ++e)
    add(4 + e, 0.25 * b[kTetShape.edge[e][0]] * b[kTetShape.edge[e][1]]);
  return out;
}

// The four corners of each child of a tet, numbered as the nodes of a Tet10: one at every corner, four around
// one of the three diagonals between the middles of opposite edges.
constexpr std::array<std::array<std::size_t, 4>, 4> kOuterChildren{
    {{0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3}}};
struct Diagonal {
  std::array<std::size_t, 2> ends;
  std::array<std::size_t, 4> around;  // counterclockwise seen from the first end
};
// Of diagonals as long as each other the first is taken. In the tets of a box these are the ones that make
// the tets of the finer box.
constexpr std::array<Diagonal, 3> kDiagonals{
    {{{6, 8}, {4, 5, 9, 7}}, {{4, 9}, {5, 6, 7, 8}}, {{5, 7}, {6, 4, 8, 9}}}};

// The middle of two points, or the point itself.
Barycentric middle(const Barycentric& a, const Barycentric& b) {
  Barycentric out{};
  for (std::size_t i = 0; i < 4; ++i) out[i] = (a[i] + b[i]) / 2;
  return out;
}

std::array<Barycentric, 10> tet10_nodes() {
  std::array<Barycentric, 10> out{};
  for (std::size_t i = 0; i < 4; ++i) out[i][i] = 4;
  for (std::size_t e = 0; e < 6; ++e)
    out[4 + e] = middle(out[kTetShape.edge[e][0]], out[kTetShape.edge[e][1]]);
  return out;
}

Template tet_template(bool quadratic, const Diagonal& diagonal) {
  Template t;
  const auto nodes = tet10_nodes();
  std::vector<Barycentric> places;
  const auto point = [&](const Barycentric& b) {
    const auto found = std::find(places.begin(), places.end(), b);
    const auto at_place = static_cast<std::size_t>(found - places.begin());
    if (found != places.end()) return at_place;
    places.push_back(b);
    Point p;
    const auto known = std::find(nodes.begin(), nodes.end(), b) - nodes.begin();
    if (known < (quadratic ? 10 : 4)) p.node = static_cast<int>(known);
    p.corner = corners_of(b);
    p.weights = tet_weights(b, quadratic);
    t.points.push_back(std::move(p));
    return at_place;
  };
  const auto child = [&](const std::array<std::size_t, 4>& corner) {
    for (const std::size_t c : corner) t.children.push_back(point(nodes[c]));
    for (std::size_t e = 0; quadratic && e < 6; ++e) {
      const auto& [a, b] = kTetShape.edge[e];
      t.children.push_back(point(middle(nodes[corner[a]], nodes[corner[b]])));
    }
  };
  for (const auto& corner : kOuterChildren) child(corner);
  for (std::size_t k = 0; k < 4; ++k)
    child({diagonal.ends[0], diagonal.ends[1], diagonal.around[k], diagonal.around[(k + 1) % 4]});
  return t;
}

Template hex_template() {
  Template t;
  // Points at xi = -1, 0, 1 in every direction; what a corner's sign is not equal to has it as a neighbor.
  for (int k = 0; k < 27; ++k) {
    const std::array<int, 3> xi{k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
    Point p;
    std::vector<int> corners;
    for (std::size_t a = 0; a < 8; ++a) {
      const double w = hex_function(
          a, {static_cast<double>(xi[0]), static_cast<double>(xi[1]), static_cast<double>(xi[2])});
      if (w == 0) continue;
      corners.push_back(static_cast<int>(a));
      p.weights.emplace_back(a, w);
    }
    if (corners.size() == 1) p.node = corners[0];
    p.shared = corners.size() < 8;
    for (std::size_t c = 0; p.shared && c < 4; ++c) p.corner[c] = corners[c * corners.size() / 4];
    t.points.push_back(std::move(p));
  }
  for (int child = 0; child < 8; ++child) {
    const std::array<int, 3> low{child & 1, (child >> 1) & 1, child >> 2};
    for (const auto& s : kHexSign) {
      const auto along = [&](std::size_t i) { return low[i] + (s[i] + 1) / 2; };
      t.children.push_back(static_cast<std::size_t>(along(0) + 3 * along(1) + 9 * along(2)));
    }
  }
  return t;
}

// Which children a cell gets.
class Templates {
 public:
  explicit Templates(CellType type) : type_(type) {
    if (type == CellType::hex8)
      all_.push_back(hex_template());
    else
      for (const Diagonal& d : kDiagonals) all_.push_back(tet_template(type == CellType::tet10, d));
  }

  const Template& of(const Mesh& mesh, const Index* cell) const {
    if (type_ == CellType::hex8) return all_[0];
    // The shortest diagonal leaves the children in the best shape. Lengths that differ by rounding alone are
    // equal, so that the choice depends on the shape of a cell and on nothing else.
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t d = 0; d < kDiagonals.size(); ++d) {
      const Vec3 along =
          middle_of(mesh, cell, kDiagonals[d].ends[0]) - middle_of(mesh, cell, kDiagonals[d].ends[1]);
      if (dot(along, along) < (1 - 1e-9) * least) {
        least = dot(along, along);
        best = d;
      }
    }
    return all_[best];
  }

 private:
  Vec3 middle_of(const Mesh& mesh, const Index* cell, std::size_t node) const {
    if (type_ == CellType::tet10) return mesh.nodes[at(cell[node])];
    const auto& [a, b] = kTetShape.edge[node - 4];
    return 0.5 * (mesh.nodes[at(cell[a])] + mesh.nodes[at(cell[b])]);
  }

  CellType type_;
  std::vector<Template> all_;
};

// One level.
class Refinement {
 public:
  explicit Refinement(const Mesh& mesh) : in_(mesh), templates_(mesh.cell_type) {}
  Result<Mesh> run();

 private:
  bool tets() const { return in_.cell_type != CellType::hex8; }
  Index point(const Index* cell, const Point& p);
  void cut_cells();
  // The children of a face, given by its corners, as keys of their nodes.
  std::vector<Key> children_of_face(const Index* face) const;
  Index find(const Key& key) const;
  void mark_surface();
  Result<void> cut_surfaces();
  void extend_node_sets();
  void extend_fields();

  const Mesh& in_;
  Templates templates_;
  Mesh out_;
  std::unordered_map<Key, Index, KeyHash> known_;
  Lists parents_;                // of each new node, nodes of the mesh
  std::vector<double> weights_;  // of these
  std::vector<bool> on_surface_;
};

Index Refinement::point(const Index* cell, const Point& p) {
  if (p.node >= 0) return cell[p.node];
  Index* place = nullptr;
  if (p.shared) {
    Key key{};
    for (std::size_t c = 0; c < 4; ++c) key[c] = cell[p.corner[c]];
    std::sort(key.begin(), key.end());
    const auto [it, fresh] = known_.try_emplace(key, out_.node_count());
    if (!fresh) return it->second;
    place = &it->second;
  }
  Vec3 x{};
  std::array<Index, 10> from{};
  std::size_t n = 0;
  for (const auto& [node, weight] : p.weights) {
    x += weight * in_.nodes[at(cell[node])];
    from[n++] = cell[node];
    weights_.push_back(weight);
  }
  parents_.push(std::span(from.data(), n));
  out_.nodes.push_back(x);
  return place ? *place : out_.node_count() - 1;
}

void Refinement::cut_cells() {
  const auto per = static_cast<std::size_t>(nodes_per_cell(in_.cell_type));
  out_.cells.reserve(8 * in_.cells.size());
  for (std::size_t c = 0; c < in_.cells.size(); c += per) {
    const Index* cell = in_.cells.data() + c;
    // Neighbors ask for the middle of an edge by its ends, also where it is a node already.
    for (std::size_t e = 0; in_.cell_type == CellType::tet10 && e < 6; ++e) {
      const Index a = cell[kTetShape.edge[e][0]], b = cell[kTetShape.edge[e][1]];
      known_.try_emplace(Key{std::min(a, b), std::min(a, b), std::max(a, b), std::max(a, b)}, cell[4 + e]);
    }
    const Template& t = templates_.of(in_, cell);
    std::vector<Index> node(t.points.size());
    for (std::size_t p = 0; p < node.size(); ++p) node[p] = point(cell, t.points[p]);
    for (const std::size_t p : t.children) out_.cells.push_back(node[p]);
  }
}

std::vector<Key> Refinement::children_of_face(const Index* face) const {
  std::vector<Key> keys;
  const auto push = [&](Key key) {
    std::sort(key.begin(), key.end());
    keys.push_back(key);
  };
  if (!tets()) {
    for (std::size_t c = 0; c < 4; ++c) {
      const Index a = face[c], b = face[(c + 1) % 4], d = face[(c + 3) % 4];
      push({a, a, a, a});
      push({a, a, b, b});
      push({face[0], face[1], face[2], face[3]});
      push({a, a, d, d});
    }
    return keys;
  }
  using Corner = std::array<int, 3>;
  const Corner a{4, 0, 0}, b{0, 4, 0}, c{0, 0, 4}, ab{2, 2, 0}, bc{0, 2, 2}, ca{2, 0, 2};
  const auto key_of = [&](const Corner& p, const Corner& q) {
    Key key{};
    std::size_t n = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      for (int k = 0; k < (p[i] + q[i]) / 2; ++k) key[n++] = face[i];
    }
    return key;
  };
  for (const auto& child : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
    for (const Corner& p : child) push(key_of(p, p));
    for (std::size_t k = 0; in_.cell_type == CellType::tet10 && k < 3; ++k)
      push(key_of(child[k], child[(k + 1) % 3]));
  }
  return keys;
}

Index Refinement::find(const Key& key) const {
  if (key[0] == key[3]) return key[0];
  const auto found = known_.find(key);
  return found == known_.end() ? -1 : found->second;
}

// Nodes of faces that one cell alone has.
void Refinement::mark_surface() {
  const CellShape& shape = cell_shape(in_.cell_type);
  struct Side {
    Key sorted{}, face{};
  };
  std::vector<Side> all;
  const auto per = static_cast<std::size_t>(nodes_per_cell(in_.cell_type));
  for (std::size_t c = 0; c < in_.cells.size(); c += per) {
    for (std::size_t s = 0; s < shape.sides; ++s) {
      Side side;
      side.face[3] = -1;
      for (std::size_t k = 0; k < shape.side_corners; ++k) side.face[k] = in_.cells[c + shape.side[s][k]];
      side.sorted = side.face;
      std::sort(side.sorted.begin(), side.sorted.end());
      all.push_back(side);
    }
  }
  std::sort(all.begin(), all.end(), [](const Side& a, const Side& b) { return a.sorted < b.sorted; });
  on_surface_.assign(out_.nodes.size(), false);
  for (std::size_t i = 0, end = 0; i < all.size(); i = end) {
    for (end = i + 1; end < all.size() && all[end].sorted == all[i].sorted;) ++end;
    if (end > i + 1) continue;
    for (const Key& key : children_of_face(all[i].face.data())) on_surface_[at(find(key))] = true;
  }
}

Result<void> Refinement::cut_surfaces() {
  const auto width = static_cast<std::size_t>(nodes_per_face(in_.cell_type));
  for (MeshSurface& surface : out_.surfaces) {
    std::vector<Index> faces;
    faces.reserve(4 * surface.faces.size());
    for (std::size_t f = 0; f + width <= surface.faces.size(); f += width) {
      for (const Key& key : children_of_face(surface.faces.data() + f)) {
        faces.push_back(find(key));
        if (faces.back() >= 0) continue;
        return Error{join("face ", f / width, " of surface ", quoted(surface.name),
                          " is a face of no cell, so the mesh cannot be refined; repair the surface, "
                          "`isochor check` tells which of its faces are so")};
      }
    }
    surface.faces = std::move(faces);
  }
  return {};
}

// A new node belongs to a set when all nodes that it lies between do. Where the set is of the surface alone,
// the new node must be there too: two sides of a thin wall are in one set without what is between them.
void Refinement::extend_node_sets() {
  const Index old = in_.node_count();
  for (MeshNodeSet& set : out_.node_sets) {
    std::vector<bool> in(out_.nodes.size(), false);
    bool surface_alone = true;
    for (const Index i : set.nodes) {
      in[at(i)] = true;
      surface_alone = surface_alone && on_surface_[at(i)];
    }
    for (Index k = 0; k < parents_.count(); ++k) {
      const auto from = parents_[k];
      const bool all = std::all_of(from.begin(), from.end(), [&](Index i) { return in[at(i)]; });
      if (all && (!surface_alone || on_surface_[at(old + k)])) set.nodes.push_back(old + k);
    }
  }
}

void Refinement::extend_fields() {
  for (MeshField& field : out_.fields) {
    const auto per = static_cast<std::size_t>(field.components);
    for (Index k = 0; k < parents_.count(); ++k) {
      const auto from = parents_[k];
      const double* weight = weights_.data() + parents_.offset[at(k)];
      for (std::size_t i = 0; i < per; ++i) {
        double value = 0;
        for (std::size_t p = 0; p < from.size(); ++p)
          value += weight[p] * field.values[at(from[p]) * per + i];
        field.values.push_back(value);
      }
    }
  }
  for (MeshField& field : out_.cell_fields) {
    const auto per = static_cast<std::size_t>(field.components);
    std::vector<double> values;
    values.reserve(8 * field.values.size());
    for (std::size_t c = 0; c + per <= field.values.size(); c += per) {
      for (int k = 0; k < 8; ++k)
        values.insert(values.end(), field.values.begin() + static_cast<std::ptrdiff_t>(c),
                      field.values.begin() + static_cast<std::ptrdiff_t>(c + per));
    }
    field.values = std::move(values);
  }
}

Result<Mesh> Refinement::run() {
  out_ = in_;
  out_.cells.clear();
  out_.cell_region.clear();
  // Numbers of the file are those of other nodes and cells.
  out_.node_label.clear();
  out_.cell_label.clear();
  cut_cells();
  for (const Index region : in_.cell_region) out_.cell_region.insert(out_.cell_region.end(), 8, region);
  mark_surface();
  if (auto r = cut_surfaces(); !r) return r.failure();
  extend_node_sets();
  extend_fields();
  return std::move(out_);
}

// Arrays that fit each other, as far as refining relies on it.
Result<void> check_arrays(const Mesh& mesh) {
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  const auto in_range = [&](const std::vector<Index>& list) {
    return std::all_of(list.begin(), list.end(), [&](Index i) { return i >= 0 && i < mesh.node_count(); });
  };
  bool fits = mesh.cells.size() % per == 0 && in_range(mesh.cells);
  for (const MeshSurface& s : mesh.surfaces) fits = fits && in_range(s.faces);
  for (const MeshNodeSet& s : mesh.node_sets) fits = fits && in_range(s.nodes);
  for (const MeshField& f : mesh.fields)
    fits = fits && f.components > 0 &&
           f.values.size() == mesh.nodes.size() * static_cast<std::size_t>(f.components);
  if (fits) return {};
  return Error{
      "the arrays of the mesh contradict each other, so it cannot be refined; `isochor check` says where"};
}

}  // namespace

Result<Mesh> refine_mesh(const Mesh& mesh, int levels) {
  if (levels < 0 || levels > kMostLevels) {
    return Error{join("refine = ", levels, "; give a number from 0 to ", kMostLevels,
                      ", each makes eight cells of one")};
  }
  if (auto r = check_arrays(mesh); !r) return r.failure();
  if (levels > 0 && mesh.cell_type == CellType::tri3)
    return Error{
        join("refine = ", levels, ": meshes of triangles are not refined here; mesh the surface finer")};
  const double cells = std::pow(8.0, levels) * mesh.cell_count();
  if (const auto why = too_large_for_memory(cells, mesh.cell_type, MeshUse::check);
      levels > 0 && !why.empty())
    return Error{join("refined ", levels, " times, ", why), ErrorKind::no_memory};
  if (levels > 0 && cells * nodes_per_cell(mesh.cell_type) > std::numeric_limits<Index>::max()) {
    return Error{join("refined ", levels, " times, the mesh has ", static_cast<std::int64_t>(cells),
                      " cells, more than can be numbered; refine it less")};
  }
  Mesh out = mesh;
  for (int level = 0; level < levels; ++level) {
    auto finer = Refinement(out).run();
    if (!finer) return finer;
    out = std::move(finer).value();
  }
  return out;
}

}  // namespace isochor
