// Uniform refinement: what the mesh says stays true, whatever its cells.
#include <map>
#include <set>

#include "isochor/generate.h"
#include "mesh_support.h"
#include "support/meshes.h"

using namespace mesh_test;
using isochor::check_mesh;
using isochor::refine_mesh;

namespace {

std::string library_mesh(const std::string& name) {
  return std::string(ISOCHOR_SCENES) + "/meshes/" + name + ".msh";
}

Mesh refined(const Mesh& mesh, int levels = 1) {
  auto r = refine_mesh(mesh, levels);
  INFO((r ? std::string() : r.error()));
  REQUIRE(r.ok());
  return std::move(r).value();
}

const Vec3& node(const Mesh& mesh, Index i) {
  return mesh.nodes[static_cast<std::size_t>(i)];
}

// Half the integral of x cross dx along an edge, straight or through a middle node: summed around a face its
// area as a vector, whatever the surface inside.
Vec3 swept(const Vec3& a, const Vec3& b) {
  return 0.5 * cross(a, b);
}
Vec3 swept(const Vec3& a, const Vec3& m, const Vec3& b) {
  Vec3 sum{};
  for (const double t : {0.5 - std::sqrt(1.0 / 12), 0.5 + std::sqrt(1.0 / 12)}) {
    const Vec3 x = (1 - t) * (1 - 2 * t) * a + 4 * t * (1 - t) * m + t * (2 * t - 1) * b;
    const Vec3 dx = (4 * t - 3) * a + (4 - 8 * t) * m + (4 * t - 1) * b;
    sum += 0.25 * cross(x, dx);
  }
  return sum;
}

struct Area {
  Vec3 vector{};
  double flat = 0;  // of the triangles
};

Area area_of(const Mesh& mesh, const isochor::MeshSurface& s) {
  Area sum;
  const auto width = static_cast<std::size_t>(nodes_per_face(mesh.cell_type));
  const std::size_t corners = width == 4 ? 4 : 3;
  for (std::size_t f = 0; f < s.faces.size(); f += width) {
    Vec3 one{};
    for (std::size_t k = 0; k < corners; ++k) {
      const Vec3 &a = node(mesh, s.faces[f + k]), &b = node(mesh, s.faces[f + (k + 1) % corners]);
      one += width == 6 ? swept(a, node(mesh, s.faces[f + 3 + k]), b) : swept(a, b);
    }
    sum.vector += one;
    sum.flat += std::sqrt(dot(one, one));
  }
  return sum;
}

double distance(const Vec3& a, const Vec3& b) {
  return std::sqrt(dot(a - b, a - b));
}

// The integral of the Jacobian over curved tets: Gauss points on a cube, whose one side is drawn together to
// an edge and this to a corner.
double curved_volume(const Mesh& mesh) {
  const double g = std::sqrt(1.2), at[4] = {-std::sqrt((3 + 2 * g) / 7), -std::sqrt((3 - 2 * g) / 7),
                                            std::sqrt((3 - 2 * g) / 7), std::sqrt((3 + 2 * g) / 7)};
  const double outer = (18 - std::sqrt(30)) / 36, inner = (18 + std::sqrt(30)) / 36,
               weight[4] = {outer, inner, inner, outer};
  constexpr std::size_t edge[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  double sum = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); c += 10) {
    for (int p = 0; p < 64; ++p) {
      const double u = 0.5 + 0.5 * at[p % 4], v = 0.5 + 0.5 * at[p / 4 % 4], w = 0.5 + 0.5 * at[p / 16];
      const double l[4] = {(1 - u) * (1 - v) * (1 - w), u * (1 - v) * (1 - w), v * (1 - w), w};
      // Derivatives by the barycentric coordinates, as if these were free.
      std::array<Vec3, 4> d{};
      for (std::size_t a = 0; a < 4; ++a) d[a] += (4 * l[a] - 1) * node(mesh, mesh.cells[c + a]);
      for (std::size_t e = 0; e < 6; ++e) {
        const Vec3& m = node(mesh, mesh.cells[c + 4 + e]);
        d[edge[e][0]] += 4 * l[edge[e][1]] * m;
        d[edge[e][1]] += 4 * l[edge[e][0]] * m;
      }
      const double jacobian = dot(cross(d[1] - d[0], d[2] - d[0]), d[3] - d[0]);
      sum +=
          0.125 * weight[p % 4] * weight[p / 4 % 4] * weight[p / 16] * (1 - v) * (1 - w) * (1 - w) * jacobian;
    }
  }
  return sum;
}

// Cells as the sets of their nodes' places, on a grid that rounding does not reach.
std::multiset<std::vector<std::array<long, 3>>> places_of_cells(const Mesh& mesh) {
  std::multiset<std::vector<std::array<long, 3>>> all;
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  for (std::size_t c = 0; c < mesh.cells.size(); c += per) {
    std::vector<std::array<long, 3>> places;
    for (std::size_t k = 0; k < per; ++k) {
      const Vec3& x = node(mesh, mesh.cells[c + k]);
      places.push_back({std::lround(1e6 * x.x), std::lround(1e6 * x.y), std::lround(1e6 * x.z)});
    }
    std::sort(places.begin(), places.end());
    all.insert(places);
  }
  return all;
}

std::set<Index> set_of(const Mesh& mesh, std::size_t s) {
  return {mesh.node_sets.at(s).nodes.begin(), mesh.node_sets.at(s).nodes.end()};
}

// What refining must keep of any mesh.
void check_kept(const Mesh& before, const Mesh& after) {
  CHECK(after.cell_count() == 8 * before.cell_count());
  const MeshReport was = check_mesh(before), is = check_mesh(after);
  CHECK(is.usable());
  // The checker's volumes of curved cells and of what they enclose are near the exact ones alone.
  const bool curved = before.cell_type == CellType::tet10;
  const double volume_error = curved ? 1e-3 : 1e-12;
  CHECK(is.volume == Approx(was.volume).epsilon(volume_error));
  if (curved) CHECK(curved_volume(after) == Approx(curved_volume(before)).epsilon(1e-12));
  CHECK(is.parts == was.parts);
  REQUIRE(is.boundary.size() == was.boundary.size());
  for (std::size_t k = 0; k < was.boundary.size(); ++k) {
    CHECK(is.boundary[k].surface.name == was.boundary[k].surface.name);
    CHECK(is.boundary[k].volume == Approx(was.boundary[k].volume).epsilon(volume_error));
    CHECK(is.boundary[k].surface.faces.size() == 4 * was.boundary[k].surface.faces.size());
  }
  for (const MeshFinding& f : is.findings) {
    INFO(f.code << ": " << f.message);
    CHECK((find(was, f.code) != nullptr || f.code == "sliver" || f.severity == Severity::note));
  }
  REQUIRE(after.surfaces.size() == before.surfaces.size());
  for (std::size_t s = 0; s < before.surfaces.size(); ++s) {
    const Area a = area_of(before, before.surfaces[s]), b = area_of(after, after.surfaces[s]);
    CHECK(after.surfaces[s].name == before.surfaces[s].name);
    CHECK(distance(a.vector, b.vector) <= 1e-12 * (a.flat + 1e-30) * 100);
    if (before.cell_type == CellType::tet4) CHECK(b.flat == Approx(a.flat).epsilon(1e-12));
  }
}

}  // namespace

TEST_CASE("refined meshes keep volume, areas by name, chambers and shape", "[mesh]") {
  for (const char* name : {"finger_small", "spine_1", "cantilever_1_tet10", "cook3d_1_hex",
                           "thick_sphere_coarse", "thick_sphere_coarse_tet10", "thick_sphere_coarse_hex"}) {
    CAPTURE(name);
    const Mesh before = read(library_mesh(name));
    const Mesh after = refined(before);
    check_kept(before, after);
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
    check_kept(mesh, after);
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
