#include "engine/mesh/make/refining.h"

#include <algorithm>

#include "engine/mesh/words.h"

namespace isochor::refining {

namespace {

using mesh_files::join;
using mesh_files::quoted;

using Barycentric = std::array<int, 4>;  // in quarters

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

}  // namespace

Template tet_template(bool quadratic, const TetChildren& children) {
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
  for (const auto& corner : children) child(corner);
  return t;
}

Template triangle_template(const TriangleChildren& children) {
  Template t;
  std::array<std::size_t, 6> place{};
  place.fill(6);
  for (const auto& child : children) {
    for (const std::size_t c : child) {
      if (place[c] == 6) {
        place[c] = t.points.size();
        Point p;
        if (c < 3) {
          p.node = static_cast<int>(c);
        } else {
          const auto a = static_cast<int>(c - 3), b = static_cast<int>((c - 2) % 3);
          p.corner = {a, a, b, b};
          p.weights = {{static_cast<std::size_t>(a), 0.5}, {static_cast<std::size_t>(b), 0.5}};
        }
        t.points.push_back(std::move(p));
      }
      t.children.push_back(place[c]);
    }
  }
  return t;
}

namespace {

// One level.
class Refinement {
 public:
  Refinement(const Mesh& mesh, const Cuts& cuts) : in_(mesh), cuts_(cuts) {}
  Result<Mesh> run(std::vector<Index>* parent);

 private:
  bool tets() const { return in_.cell_type != CellType::hex8; }
  Index point(const Index* cell, const Point& p);
  void cut_cells();
  // The children of a face, given by its corners, as keys of their nodes.
  std::vector<Key> children_of_face(const Index* face) const;
  Index find(const Key& key) const;
  void mark_surface();
  void mark_rim();
  Result<void> cut_surfaces();
  void extend_node_sets();
  void extend_fields();

  const Mesh& in_;
  const Cuts& cuts_;
  Mesh out_;
  std::vector<Index> parent_;  // of each new cell
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
  out_.cells.reserve(in_.cells.size());
  for (std::size_t c = 0; c < in_.cells.size(); c += per) {
    const Index* cell = in_.cells.data() + c;
    // Neighbors ask for the middle of an edge by its ends, also where it is a node already.
    for (std::size_t e = 0; in_.cell_type == CellType::tet10 && e < 6; ++e) {
      const Index a = cell[kTetShape.edge[e][0]], b = cell[kTetShape.edge[e][1]];
      known_.try_emplace(Key{std::min(a, b), std::min(a, b), std::max(a, b), std::max(a, b)}, cell[4 + e]);
    }
    const Template& t = cuts_.of(cell);
    std::vector<Index> node(t.points.size());
    for (std::size_t p = 0; p < node.size(); ++p) node[p] = point(cell, t.points[p]);
    for (const std::size_t p : t.children) out_.cells.push_back(node[p]);
    parent_.resize(out_.cells.size() / per, static_cast<Index>(c / per));
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
  constexpr std::array<Corner, 6> place{{{4, 0, 0}, {0, 4, 0}, {0, 0, 4}, {2, 2, 0}, {0, 2, 2}, {2, 0, 2}}};
  const auto key_of = [&](const Corner& p, const Corner& q) {
    Key key{};
    std::size_t n = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      for (int k = 0; k < (p[i] + q[i]) / 2; ++k) key[n++] = face[i];
    }
    return key;
  };
  for (const auto& child : cuts_.of_triangle(face)) {
    for (const std::size_t p : child) push(key_of(place[p], place[p]));
    for (std::size_t k = 0; in_.cell_type == CellType::tet10 && k < 3; ++k)
      push(key_of(place[child[k]], place[child[(k + 1) % 3]]));
  }
  return keys;
}

Index Refinement::find(const Key& key) const {
  if (key[0] == key[3]) return key[0];
  const auto found = known_.find(key);
  return found == known_.end() ? -1 : found->second;
}

// Of triangles: nodes of edges that one of them alone has.
void Refinement::mark_rim() {
  std::unordered_map<Key, int, KeyHash> faces;
  const auto middle_of = [](Index a, Index b) {
    return Key{std::min(a, b), std::min(a, b), std::max(a, b), std::max(a, b)};
  };
  for (std::size_t k = 0; k < in_.cells.size(); ++k)
    ++faces[middle_of(in_.cells[k], in_.cells[k % 3 < 2 ? k + 1 : k - 2])];
  on_surface_.assign(out_.nodes.size(), false);
  for (const auto& [edge, count] : faces) {
    if (count > 1) continue;
    on_surface_[at(edge[0])] = on_surface_[at(edge[3])] = true;
    if (const Index middle = find(edge); middle >= 0) on_surface_[at(middle)] = true;
  }
}

// Nodes of faces that one cell alone has.
void Refinement::mark_surface() {
  if (in_.cell_type == CellType::tri3) return mark_rim();
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
    values.reserve(parent_.size() * per);
    for (const Index c : parent_) {
      const auto from = field.values.begin() + static_cast<std::ptrdiff_t>(at(c) * per);
      values.insert(values.end(), from, from + field.components);
    }
    field.values = std::move(values);
  }
}

Result<Mesh> Refinement::run(std::vector<Index>* parent) {
  out_ = in_;
  out_.cells.clear();
  out_.cell_region.clear();
  // Numbers of the file are those of other nodes and cells.
  out_.node_label.clear();
  out_.cell_label.clear();
  cut_cells();
  for (std::size_t c = 0; !in_.cell_region.empty() && c < parent_.size(); ++c)
    out_.cell_region.push_back(in_.cell_region[at(parent_[c])]);
  mark_surface();
  if (auto r = cut_surfaces(); !r) return r.failure();
  extend_node_sets();
  extend_fields();
  if (parent) *parent = std::move(parent_);
  return std::move(out_);
}

}  // namespace

Result<Mesh> cut(const Mesh& mesh, const Cuts& cuts, std::vector<Index>* parent) {
  return Refinement(mesh, cuts).run(parent);
}

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

}  // namespace isochor::refining
