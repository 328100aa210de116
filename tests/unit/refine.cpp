// Uniform refinement: what the mesh says stays true, whatever its cells.
#include "refine_support.h"

using namespace refine_test;
using isochor::refine_mesh;

namespace {

Mesh refined(const Mesh& mesh, int levels = 1) {
  auto r = refine_mesh(mesh, levels);
  INFO((r ? std::string() : r.error()));
  REQUIRE(r.ok());
  return std::move(r).value();
}

void check_kept_by_eight(const Mesh& before, const Mesh& after) {
  CHECK(after.cell_count() == 8 * before.cell_count());
  check_kept(before, after);
  const MeshReport was = check_mesh(before), is = check_mesh(after);
  for (std::size_t k = 0; k < was.boundary.size(); ++k)
    CHECK(is.boundary[k].surface.faces.size() == 4 * was.boundary[k].surface.faces.size());
}

}  // namespace

TEST_CASE("refined meshes keep volume, areas by name, chambers and shape", "[mesh]") {
  for (const char* name : {"finger_small", "spine_1", "cantilever_1_tet10", "cook3d_1_hex",
                           "thick_sphere_coarse", "thick_sphere_coarse_tet10", "thick_sphere_coarse_hex"}) {
    CAPTURE(name);
    const Mesh before = read(library_mesh(name));
    const Mesh after = refined(before);
    check_kept_by_eight(before, after);
    CHECK(after.regions == before.regions);
    for (Index c = 0; c < after.cell_count() && !before.cell_region.empty(); ++c) {
      if (after.cell_region[static_cast<std::size_t>(c)] !=
          before.cell_region[static_cast<std::size_t>(c / 8)])
        FAIL("cell " << c << " changed its region");
    }
    CHECK(check_mesh(after).worst_quality > 0.4 * check_mesh(before).worst_quality);
  }
}

TEST_CASE("quality sinks once and not with every level", "[mesh]") {
  for (const char* name : {"thick_sphere_coarse", "torsion_cylinder_coarse"}) {
    CAPTURE(name);
    const Mesh before = read(library_mesh(name));
    const double once = check_mesh(refined(before)).worst_quality;
    const double twice = check_mesh(refined(before, 2)).worst_quality;
    CHECK(twice > 0.9 * once);
  }
}

TEST_CASE("a refined box is the finer box", "[mesh]") {
  for (const CellType type : {CellType::tet4, CellType::hex8}) {
    const Vec3 upper{1, 0.5, 2};
    const Mesh coarse = test::box({3, 2, 1}, upper, type), fine = test::box({6, 4, 2}, upper, type);
    const Mesh after = refined(coarse);
    CHECK(places_of_cells(after) == places_of_cells(fine));
    CHECK(after.node_count() == fine.node_count());
    // The middle of an edge before or after it was raised to Tet10.
    if (type == CellType::tet4)
      CHECK(places_of_cells(isochor::to_tet10(after)) == places_of_cells(refined(isochor::to_tet10(coarse))));
  }
}

TEST_CASE("refined meshes of any numbering and shape are conforming", "[mesh]") {
  std::mt19937 random(7);
  for (unsigned seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    const CellType type = std::array{CellType::tet4, CellType::tet10, CellType::hex8}[seed % 3];
    std::vector<Index> place;
    Mesh mesh = test::box({2 + static_cast<int>(seed % 2), 2, 3}, {1, 1, 1}, type);
    if (type != CellType::hex8) mesh = test::shuffled(mesh, seed, place);
    // Of a Tet10 the middle nodes move as well: its edges and faces are curved.
    const double most = type == CellType::tet10 ? 0.01 : 0.04;
    std::uniform_real_distribution<double> shift(-most, most);
    for (Vec3& x : mesh.nodes) x += Vec3{shift(random), shift(random), shift(random)};
    const Mesh after = refined(mesh);
    check_kept_by_eight(mesh, after);
    CHECK(find(check_mesh(after), "non-manifold-face") == nullptr);
    CHECK(find(check_mesh(after), "duplicate-node") == nullptr);
    CHECK(after.nodes == refined(mesh).nodes);
    CHECK(after.cells == refined(mesh).cells);
  }
}

TEST_CASE("fields at nodes are interpolated by the shape functions, those in cells handed down", "[mesh]") {
  for (const CellType type : {CellType::tet4, CellType::tet10, CellType::hex8}) {
    CAPTURE(static_cast<int>(type));
    Mesh mesh = test::box({2, 2, 2}, {1, 1, 1}, type);
    const auto value = [&](const Vec3& x) {
      const double line = 1 + 2 * x.x - x.y + 3 * x.z;
      return type == CellType::tet10 ? line + x.x * x.y - x.z * x.z : line;
    };
    mesh.fields = {{"smooth", 2, {}}};
    for (const Vec3& x : mesh.nodes) {
      mesh.fields[0].values.push_back(value(x));
      mesh.fields[0].values.push_back(-1);
    }
    mesh.cell_fields = {{"number", 1, {}}};
    for (Index c = 0; c < mesh.cell_count(); ++c) mesh.cell_fields[0].values.push_back(c);
    const Mesh after = refined(mesh, 2);
    REQUIRE(after.fields.at(0).values.size() == 2 * after.nodes.size());
    for (std::size_t i = 0; i < after.nodes.size(); ++i) {
      if (std::abs(after.fields[0].values[2 * i] - value(after.nodes[i])) > 1e-13) FAIL("node " << i);
      if (after.fields[0].values[2 * i + 1] != -1) FAIL("node " << i);
    }
    REQUIRE(after.cell_fields.at(0).values.size() == static_cast<std::size_t>(after.cell_count()));
    for (std::size_t c = 0; c < after.cell_fields[0].values.size(); ++c) {
      if (after.cell_fields[0].values[c] != static_cast<double>(c / 64)) FAIL("cell " << c);
    }
  }
}

TEST_CASE("node sets of the surface stay on it, others take what lies between their nodes", "[mesh]") {
  for (const CellType type : {CellType::tet4, CellType::tet10, CellType::hex8}) {
    CAPTURE(static_cast<int>(type));
    Mesh mesh = test::box({3, 3, 1}, {3, 3, 1}, type);  // one layer: every node is on the surface
    isochor::MeshNodeSet skin{"skin", {}}, bottom{"bottom", {}}, one{"one", {0}};
    for (Index i = 0; i < mesh.node_count(); ++i) {
      const Vec3& x = node(mesh, i);
      const auto outside = [](double v, double end) { return v == 0 || v == end; };
      if (outside(x.x, 3) || outside(x.y, 3) || outside(x.z, 1)) skin.nodes.push_back(i);
      if (x.z == 0) bottom.nodes.push_back(i);
    }
    Mesh solid = test::box({2, 2, 2}, {2, 2, 2}, type);
    isochor::MeshNodeSet half{"half", {}};
    for (Index i = 0; i < solid.node_count(); ++i) {
      if (node(solid, i).x <= 1) half.nodes.push_back(i);
    }
    mesh.node_sets = {skin, bottom, one};
    solid.node_sets = {half};
    const Mesh thin = refined(mesh), thick = refined(solid);
    std::set<Index> on_skin, on_bottom, in_half;
    for (Index i = 0; i < thin.node_count(); ++i) {
      const Vec3& x = node(thin, i);
      if (x.x == 0 || x.x == 3 || x.y == 0 || x.y == 3 || x.z == 0 || x.z == 1) on_skin.insert(i);
      if (x.z == 0) on_bottom.insert(i);
    }
    for (Index i = 0; i < thick.node_count(); ++i) {
      if (node(thick, i).x <= 1) in_half.insert(i);
    }
    CHECK(set_of(thin, 0) == on_skin);
    CHECK(set_of(thin, 1) == on_bottom);
    CHECK(set_of(thin, 2) == std::set<Index>{0});
    CHECK(set_of(thick, 0) == in_half);
  }
}

TEST_CASE("what cannot be refined is refused in a sentence", "[mesh]") {
  const Mesh mesh = test::box({1, 1, 1});
  for (const int levels : {-1, 9}) {
    const auto r = refine_mesh(mesh, levels);
    REQUIRE_FALSE(r.ok());
    CHECK(mentions(r.error(), {std::to_string(levels), "from 0 to 8"}));
  }
  CHECK(refined(mesh, 0).cells == mesh.cells);
  Mesh off = mesh;
  off.surfaces.push_back({"loose", {0, 3, 4}});
  CHECK(mentions(refine_mesh(off).error(), {"loose", "face of no cell"}));
  Mesh broken = mesh;
  broken.cells[0] = 99;
  CHECK(mentions(refine_mesh(broken).error(), {"isochor check"}));
  const auto huge = refine_mesh(test::box({40, 40, 40}), 8);
  REQUIRE_FALSE(huge.ok());
  CHECK(mentions(huge.error(), {"refined"}));
}
