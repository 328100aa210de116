// Local refinement of tets and triangles by longest-edge bisection (Rivara; in three dimensions Plaza & Carey
// 2000, "Local refinement of simplicial grids based on the skeleton", Applied Numerical Mathematics 32).
//
// 1. All edges of the cells to refine are marked.
// 2. Where an edge of a cell or of a face is marked, so is its longest one, until nothing changes. The
// longest
//    is that of one order of all edges of the mesh, in which no two are equal.
// 3. Every cell is cut in two at its first marked edge in that order, then its halves at theirs. What a face
//    gets depends on its own edges and the order alone, so cells that share it agree.
#include <algorithm>
#include <map>

#include "engine/base/available_memory.h"
#include "engine/mesh/make/refining.h"
#include "engine/mesh/words.h"
#include "isochor/generate.h"

namespace isochor {

namespace {

using mesh_files::join;
using namespace refining;

using Edge = std::array<std::size_t, 2>;
constexpr std::array<Edge, 3> kTriangleEdges{{{0, 1}, {1, 2}, {2, 0}}};
constexpr std::span<const Edge> kTetEdges = std::span(kTetShape.edge).first(kTetShape.edges);
constexpr std::array<std::array<std::size_t, 3>, 4> kFaceEdges{{{1, 4, 5}, {2, 5, 3}, {0, 4, 3}, {2, 1, 0}}};

// Bisects a shape of N corners at some of its edges, one after the other; the middle of edge e is point N +
// e. An edge that is cut has both its ends in the pieces that it belongs to, and no piece gets a new edge
// that is cut.
template <std::size_t N>
std::vector<std::array<std::size_t, N>> bisected(std::span<const Edge> edges,
                                                 std::span<const std::uint8_t> cut) {
  std::array<std::size_t, N> whole{};
  for (std::size_t i = 0; i < N; ++i) whole[i] = i;
  std::vector<std::array<std::size_t, N>> pieces{whole};
  for (const std::uint8_t e : cut) {
    for (std::size_t p = 0, count = pieces.size(); p < count; ++p) {
      auto half = pieces[p];
      const auto a = std::find(half.begin(), half.end(), edges[e][0]);
      const auto b = std::find(pieces[p].begin(), pieces[p].end(), edges[e][1]);
      if (a == half.end() || b == pieces[p].end()) continue;
      *a = *b = N + e;
      pieces.push_back(half);
    }
  }
  return pieces;
}

class Bisections : public Cuts {
 public:
  Bisections(const Mesh& mesh, std::span<const Index> cells);

  const Template& of(const Index* cell) const override;
  TriangleChildren of_triangle(const Index* corners) const override;
  // How many cells there will be.
  double cells() const;

 private:
  using Ends = std::array<Index, 2>;
  static Ends ends(Index a, Index b) { return {std::min(a, b), std::max(a, b)}; }
  const Index* corners(std::size_t cell) const { return mesh_.cells.data() + cell * per_; }
  std::span<const Index> edges_of(std::size_t cell) const {
    return std::span(of_cell_).subspan(shape_.size() * cell, shape_.size());
  }
  Index number_of(const Ends& e) const;
  bool mark_longest(std::span<const Index> edges);
  void close();
  // Marked ones among the edges with these ends, in the order in which they are cut.
  std::vector<std::uint8_t> cut_edges(const Index* corner, std::span<const Edge> edges) const;

  const Mesh& mesh_;
  std::size_t per_;
  std::span<const Edge> shape_;  // edges of a cell by its corners
  std::vector<Ends> edge_;       // the longest first
  std::vector<Index> of_cell_;
  std::vector<std::uint8_t> marked_;
  std::unordered_map<std::uint64_t, Index> number_;
  mutable std::map<std::uint32_t, Template> templates_;  // by the edges that are cut
};

std::uint64_t packed(const std::array<Index, 2>& e) {
  return static_cast<std::uint64_t>(e[0]) << 32 | static_cast<std::uint32_t>(e[1]);
}

Bisections::Bisections(const Mesh& mesh, std::span<const Index> cells)
    : mesh_(mesh),
      per_(static_cast<std::size_t>(nodes_per_cell(mesh.cell_type))),
      shape_(mesh.cell_type == CellType::tri3 ? std::span<const Edge>(kTriangleEdges) : kTetEdges) {
  for (std::size_t c = 0; c < at(mesh.cell_count()); ++c) {
    for (const Edge& e : shape_) edge_.push_back(ends(corners(c)[e[0]], corners(c)[e[1]]));
  }
  std::vector<Ends> all = edge_;
  const auto length2 = [&](const Ends& e) {
    const Vec3 d = mesh.nodes[at(e[1])] - mesh.nodes[at(e[0])];
    return dot(d, d);
  };
  std::sort(edge_.begin(), edge_.end());
  edge_.erase(std::unique(edge_.begin(), edge_.end()), edge_.end());
  std::stable_sort(edge_.begin(), edge_.end(),
                   [&](const Ends& a, const Ends& b) { return length2(a) > length2(b); });
  number_.reserve(edge_.size());
  for (std::size_t e = 0; e < edge_.size(); ++e) number_.emplace(packed(edge_[e]), static_cast<Index>(e));
  of_cell_.reserve(all.size());
  for (const Ends& e : all) of_cell_.push_back(number_of(e));
  marked_.assign(edge_.size(), 0);
  for (const Index c : cells) {
    for (const Index e : edges_of(at(c))) marked_[at(e)] = 1;
  }
  close();
}

Index Bisections::number_of(const Ends& e) const {
  const auto found = number_.find(packed(e));
  return found == number_.end() ? -1 : found->second;
}

// True when that changed something.
bool Bisections::mark_longest(std::span<const Index> edges) {
  const Index longest = *std::min_element(edges.begin(), edges.end());
  const bool any = std::any_of(edges.begin(), edges.end(), [&](Index e) { return marked_[at(e)] != 0; });
  if (!any || marked_[at(longest)] != 0) return false;
  marked_[at(longest)] = 1;
  return true;
}

void Bisections::close() {
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t c = 0; c < at(mesh_.cell_count()); ++c) {
      const auto all = edges_of(c);
      for (std::size_t f = 0; all.size() == kTetShape.edges && f < kFaceEdges.size(); ++f) {
        const auto& face = kFaceEdges[f];
        const std::array<Index, 3> three{all[face[0]], all[face[1]], all[face[2]]};
        changed = mark_longest(three) || changed;
      }
      changed = mark_longest(all) || changed;
    }
  }
}

std::vector<std::uint8_t> Bisections::cut_edges(const Index* corner, std::span<const Edge> edges) const {
  std::vector<std::pair<Index, std::uint8_t>> found;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const Index e = number_of(ends(corner[edges[k][0]], corner[edges[k][1]]));
    if (e >= 0 && marked_[at(e)] != 0) found.emplace_back(e, static_cast<std::uint8_t>(k));
  }
  std::sort(found.begin(), found.end());
  std::vector<std::uint8_t> out;
  for (const auto& [e, k] : found) out.push_back(k);
  return out;
}

const Template& Bisections::of(const Index* cell) const {
  const auto cut = cut_edges(cell, shape_);
  std::uint32_t key = 1;
  for (const std::uint8_t e : cut) key = 8 * key + e;
  const auto [it, fresh] = templates_.try_emplace(key);
  if (fresh && shape_.size() == kTriangleEdges.size())
    it->second = triangle_template(bisected<3>(kTriangleEdges, cut));
  else if (fresh)
    it->second = tet_template(mesh_.cell_type == CellType::tet10, bisected<4>(kTetEdges, cut));
  return it->second;
}

TriangleChildren Bisections::of_triangle(const Index* corner) const {
  return bisected<3>(kTriangleEdges, cut_edges(corner, kTriangleEdges));
}

double Bisections::cells() const {
  double sum = 0;
  for (std::size_t c = 0; c < at(mesh_.cell_count()); ++c)
    sum += static_cast<double>(of(corners(c)).children.size() / per_);
  return sum;
}

}  // namespace

Result<RefinedMesh> refine_cells(const Mesh& mesh, std::span<const Index> cells) {
  if (mesh.cell_type == CellType::hex8) {
    return Error{
        "hexahedra are not refined cell by cell, for their neighbors would have nodes in the middle of "
        "faces; "
        "take refine_mesh(), which cuts all of them, or a mesh of tets"};
  }
  if (auto r = check_arrays(mesh); !r) return r.failure();
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (cells[k] >= 0 && cells[k] < mesh.cell_count()) continue;
    return Error{join("refine_cells: cells[", k, "] = ", cells[k], ", and the mesh has cells 0 to ",
                      mesh.cell_count() - 1)};
  }
  const Bisections cuts(mesh, cells);
  if (const auto why = too_large_for_memory(cuts.cells(), mesh.cell_type, MeshUse::check); !why.empty())
    return Error{join("refined, ", why), ErrorKind::no_memory};
  RefinedMesh out;
  auto finer = cut(mesh, cuts, &out.parent);
  if (!finer) return finer.failure();
  out.mesh = std::move(finer).value();
  return out;
}

}  // namespace isochor
