// Uniform refinement: every cell into eight of its own shape, triangles into four.
#include <cmath>
#include <limits>

#include "engine/base/available_memory.h"
#include "engine/mesh/make/refining.h"
#include "engine/mesh/words.h"
#include "isochor/generate.h"

namespace isochor {

namespace {

using mesh_files::join;
using namespace refining;

constexpr int kMostLevels = 8;

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

TetChildren children_around(const Diagonal& diagonal) {
  TetChildren out(kOuterChildren.begin(), kOuterChildren.end());
  for (std::size_t k = 0; k < 4; ++k)
    out.push_back({diagonal.ends[0], diagonal.ends[1], diagonal.around[k], diagonal.around[(k + 1) % 4]});
  return out;
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

TriangleChildren four_triangles() {
  return {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};
}

// Of triangles four.
class EightChildren : public Cuts {
 public:
  explicit EightChildren(const Mesh& mesh) : mesh_(mesh) {
    if (mesh.cell_type == CellType::hex8)
      all_.push_back(hex_template());
    else if (mesh.cell_type == CellType::tri3)
      all_.push_back(triangle_template(four_triangles()));
    else
      for (const Diagonal& d : kDiagonals)
        all_.push_back(tet_template(mesh.cell_type == CellType::tet10, children_around(d)));
  }

  const Template& of(const Index* cell) const override {
    if (all_.size() == 1) return all_[0];
    // The shortest diagonal leaves the children in the best shape. Lengths that differ by rounding alone are
    // equal, so that the choice depends on the shape of a cell and on nothing else.
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t d = 0; d < kDiagonals.size(); ++d) {
      const Vec3 along = middle_of(cell, kDiagonals[d].ends[0]) - middle_of(cell, kDiagonals[d].ends[1]);
      if (dot(along, along) < (1 - 1e-9) * least) {
        least = dot(along, along);
        best = d;
      }
    }
    return all_[best];
  }

  TriangleChildren of_triangle(const Index*) const override { return four_triangles(); }

 private:
  Vec3 middle_of(const Index* cell, std::size_t node) const {
    if (mesh_.cell_type == CellType::tet10) return mesh_.nodes[at(cell[node])];
    const auto& [a, b] = kTetShape.edge[node - 4];
    return 0.5 * (mesh_.nodes[at(cell[a])] + mesh_.nodes[at(cell[b])]);
  }

  const Mesh& mesh_;
  std::vector<Template> all_;
};

}  // namespace

Result<Mesh> refine_mesh(const Mesh& mesh, int levels) {
  if (levels < 0 || levels > kMostLevels) {
    return Error{join("refine = ", levels, "; give a number from 0 to ", kMostLevels,
                      ", each makes eight cells of one")};
  }
  if (auto r = check_arrays(mesh); !r) return r.failure();
  const double cells = std::pow(mesh.cell_type == CellType::tri3 ? 4.0 : 8.0, levels) * mesh.cell_count();
  if (const auto why = too_large_for_memory(cells, mesh.cell_type, MeshUse::check);
      levels > 0 && !why.empty())
    return Error{join("refined ", levels, " times, ", why), ErrorKind::no_memory};
  if (levels > 0 && cells * nodes_per_cell(mesh.cell_type) > std::numeric_limits<Index>::max()) {
    return Error{join("refined ", levels, " times, the mesh has ", static_cast<std::int64_t>(cells),
                      " cells, more than can be numbered; refine it less")};
  }
  Mesh out = mesh;
  for (int level = 0; level < levels; ++level) {
    auto finer = cut(out, EightChildren(out));
    if (!finer) return finer;
    out = std::move(finer).value();
  }
  return out;
}

}  // namespace isochor
