// Local refinement of tets: the mesh stays one, whatever is chosen, and cells keep their shape.
#include <random>

#include "refine_support.h"

using namespace refine_test;
using isochor::refine_cells;
using isochor::RefinedMesh;

namespace {

RefinedMesh refined(const Mesh& mesh, const std::vector<Index>& cells) {
  auto r = refine_cells(mesh, cells);
  INFO((r ? std::string() : r.error()));
  REQUIRE(r.ok());
  return std::move(r).value();
}

std::vector<Index> some_cells(const Mesh& mesh, double share, std::mt19937& random) {
  std::bernoulli_distribution chosen(share);
  std::vector<Index> cells;
  for (Index c = 0; c < mesh.cell_count(); ++c) {
    if (chosen(random)) cells.push_back(c);
  }
  return cells;
}

std::vector<Index> all_cells(const Mesh& mesh) {
  std::vector<Index> cells(static_cast<std::size_t>(mesh.cell_count()));
  for (std::size_t c = 0; c < cells.size(); ++c) cells[c] = static_cast<Index>(c);
  return cells;
}

std::vector<int> pieces_of(const Mesh& before, const RefinedMesh& after) {
  std::vector<int> pieces(static_cast<std::size_t>(before.cell_count()));
  REQUIRE(after.parent.size() == static_cast<std::size_t>(after.mesh.cell_count()));
  for (const Index p : after.parent) ++pieces.at(static_cast<std::size_t>(p));
  return pieces;
}

// Those at a point that errors pile up at.
std::vector<Index> cells_at(const Mesh& mesh, Index corner) {
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  std::vector<Index> cells;
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    if (mesh.cells[k] == corner) cells.push_back(static_cast<Index>(k / per));
  }
  return cells;
}

// The longest edge of a cell that is cut is cut, so that no shape grows thinner than another does.
void check_longest_edges(const Mesh& before, const RefinedMesh& after) {
  const auto per = static_cast<std::size_t>(nodes_per_cell(before.cell_type));
  const auto pieces = pieces_of(before, after);
  for (std::size_t c = 0; c < after.parent.size(); ++c) {
    const auto parent = static_cast<std::size_t>(after.parent[c]);
    if (pieces[parent] == 1) continue;
    std::array<Index, 2> longest{};
    double length = 0;
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const Index i = before.cells[per * parent + a], j = before.cells[per * parent + b];
        if (distance(node(before, i), node(before, j)) <= length) continue;
        length = distance(node(before, i), node(before, j));
        longest = {i, j};
      }
    }
    const auto corners = std::span(after.mesh.cells).subspan(per * c, 4);
    const auto has = [&](Index i) { return std::find(corners.begin(), corners.end(), i) != corners.end(); };
    if (has(longest[0]) && has(longest[1])) FAIL("cell " << parent << " keeps its longest edge");
  }
}

}  // namespace

TEST_CASE("meshes refined at any cells keep volume, areas by name, chambers and regions", "[mesh]") {
  std::mt19937 random(3);
  for (const char* name : {"finger_small", "spine_1", "cantilever_1_tet10", "thick_sphere_coarse",
                           "thick_sphere_coarse_tet10"}) {
    const Mesh before = read(library_mesh(name));
    for (const double share : {0.01, 0.2, 0.7}) {
      CAPTURE(name, share);
      const auto cells = some_cells(before, share, random);
      const RefinedMesh after = refined(before, cells);
      check_kept(before, after.mesh);
      const auto pieces = pieces_of(before, after);
      for (const Index c : cells) CHECK(pieces[static_cast<std::size_t>(c)] == 8);
      CHECK(*std::max_element(pieces.begin(), pieces.end()) <= 8);
      CHECK(after.mesh.regions == before.regions);
      for (Index c = 0; c < after.mesh.cell_count() && !before.cell_region.empty(); ++c) {
        const auto parent = static_cast<std::size_t>(after.parent[static_cast<std::size_t>(c)]);
        if (after.mesh.cell_region[static_cast<std::size_t>(c)] != before.cell_region[parent])
          FAIL("cell " << c << " changed its region");
      }
    }
  }
}

TEST_CASE("local refinement of shuffled and crooked boxes is conforming, time after time", "[mesh]") {
  std::mt19937 random(11);
  for (unsigned seed = 1; seed <= 16; ++seed) {
    CAPTURE(seed);
    const CellType type = seed % 2 == 0 ? CellType::tet10 : CellType::tet4;
    std::vector<Index> place;
    Mesh mesh = test::shuffled(test::box({2, 2, 2}, {1, 1, 1}, type), seed, place);
    const double most = type == CellType::tet10 ? 0.01 : 0.06;
    std::uniform_real_distribution<double> shift(-most, most);
    for (Vec3& x : mesh.nodes) x += Vec3{shift(random), shift(random), shift(random)};
    for (int round = 0; round < 3; ++round) {
      const RefinedMesh after = refined(mesh, some_cells(mesh, 0.15, random));
      check_kept(mesh, after.mesh);
      check_longest_edges(mesh, after);
      CHECK(find(check_mesh(after.mesh), "non-manifold-face") == nullptr);
      CHECK(find(check_mesh(after.mesh), "duplicate-node") == nullptr);
      mesh = after.mesh;
    }
  }
}

TEST_CASE("what is cut is cut at its longest edge first, however few cells are chosen", "[mesh]") {
  std::mt19937 random(17);
  std::vector<Index> place;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    CAPTURE(seed);
    Mesh mesh = test::shuffled(test::box({4, 4, 4}), seed, place);
    std::uniform_real_distribution<double> shift(-0.08, 0.08);
    for (Vec3& x : mesh.nodes) x += Vec3{shift(random), shift(random), shift(random)};
    check_longest_edges(mesh, refined(mesh, some_cells(mesh, 0.01, random)));
  }
}

TEST_CASE("refining no cell changes nothing, and all cells get eight pieces", "[mesh]") {
  for (const CellType type : {CellType::tet4, CellType::tet10}) {
    const Mesh mesh = test::box({3, 2, 2}, {1, 1, 1}, type);
    const RefinedMesh same = refined(mesh, {});
    CHECK(same.mesh.nodes == mesh.nodes);
    CHECK(same.mesh.cells == mesh.cells);
    const RefinedMesh finer = refined(mesh, all_cells(mesh));
    CHECK(finer.mesh.cell_count() == 8 * mesh.cell_count());
  }
}

TEST_CASE("what is refined again and again toward a corner keeps its shape and stays local", "[mesh]") {
  for (const char* name : {"finger_small", "thick_sphere_coarse"}) {
    CAPTURE(name);
    Mesh mesh = read(library_mesh(name));
    const Index first = mesh.cell_count();
    const double once = check_mesh(refined(mesh, all_cells(mesh)).mesh).worst_quality;
    const Index corner = mesh.surfaces.at(0).faces.at(0);
    std::vector<Index> count{first};
    for (int level = 0; level < 16; ++level) {
      mesh = refined(mesh, cells_at(mesh, corner)).mesh;
      count.push_back(mesh.cell_count());
    }
    CHECK(check_mesh(mesh).usable());
    CHECK(check_mesh(mesh).worst_quality > 0.4 * once);
    // As many cells with every level.
    CHECK(count[16] - count[12] < 1.1 * (count[12] - count[8]));
  }
}

TEST_CASE("fields and node sets follow local refinement", "[mesh]") {
  std::mt19937 random(5);
  for (const CellType type : {CellType::tet4, CellType::tet10}) {
    Mesh mesh = test::box({3, 3, 3}, {3, 3, 3}, type);
    const auto value = [&](const Vec3& x) {
      const double line = 1 + 2 * x.x - x.y + 3 * x.z;
      return type == CellType::tet10 ? line + x.x * x.y - x.z * x.z : line;
    };
    mesh.fields = {{"smooth", 1, {}}};
    isochor::MeshNodeSet bottom{"bottom", {}};
    for (Index i = 0; i < mesh.node_count(); ++i) {
      mesh.fields[0].values.push_back(value(node(mesh, i)));
      if (node(mesh, i).z == 0) bottom.nodes.push_back(i);
    }
    mesh.node_sets = {bottom};
    mesh.cell_fields = {{"number", 1, {}}};
    for (Index c = 0; c < mesh.cell_count(); ++c) mesh.cell_fields[0].values.push_back(c);
    const RefinedMesh after = refined(mesh, some_cells(mesh, 0.1, random));
    std::set<Index> on_bottom;
    for (Index i = 0; i < after.mesh.node_count(); ++i) {
      const Vec3& x = node(after.mesh, i);
      if (std::abs(after.mesh.fields.at(0).values.at(static_cast<std::size_t>(i)) - value(x)) > 1e-13)
        FAIL("node " << i);
      if (x.z == 0) on_bottom.insert(i);
    }
    CHECK(set_of(after.mesh, 0) == on_bottom);
    for (std::size_t c = 0; c < after.parent.size(); ++c) {
      if (after.mesh.cell_fields.at(0).values.at(c) != static_cast<double>(after.parent[c]))
        FAIL("cell " << c);
    }
  }
}

TEST_CASE("local refinement refuses hexahedra and cells that there are not", "[mesh]") {
  const Mesh hex = test::box({1, 1, 1}, {1, 1, 1}, CellType::hex8), tets = test::box({1, 1, 1});
  CHECK(mentions(refine_cells(hex, std::vector<Index>{0}).error(), {"hexahedra", "refine_mesh"}));
  CHECK(mentions(refine_cells(tets, std::vector<Index>{0, 6}).error(), {"cells[1] = 6", "0 to 5"}));
  CHECK(mentions(refine_cells(tets, std::vector<Index>{-1}).error(), {"cells[0] = -1"}));
}
