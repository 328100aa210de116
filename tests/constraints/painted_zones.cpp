// Zones painted on surfaces: where cells are projected to, how weights share cells, what rows over them keep.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "numbers/cube.h"
#include "support/worlds.h"

using namespace isochor;
using test::value;

namespace {

Vec3 center_of(const Mesh& mesh, std::size_t cell) {
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  const std::size_t corners = mesh.cell_type == CellType::hex8 ? 8 : 4;
  Vec3 center;
  for (std::size_t k = 0; k < corners; ++k) {
    center += (1.0 / static_cast<double>(corners)) *
              mesh.nodes[static_cast<std::size_t>(mesh.cells[cell * per + k])];
  }
  return center;
}

Vec3 point_of(const Mesh& mesh, const SurfaceFoot& foot) {
  Vec3 p;
  for (std::size_t k = 0; k < 3; ++k)
    p += foot.weight[k] * mesh.nodes[static_cast<std::size_t>(foot.node[k])];
  return p;
}

Mesh painted(Mesh mesh, const std::string& name, double (*paint)(const Vec3&)) {
  MeshField field;
  field.name = name;
  for (const Vec3& x : mesh.nodes) field.values.push_back(paint(x));
  mesh.fields.push_back(std::move(field));
  return mesh;
}

double left(const Vec3& x) {
  return std::clamp((0.7 - x.x) / 0.4, 0.0, 1.0);
}
double right(const Vec3& x) {
  return std::clamp((x.x - 0.3) / 0.4, 0.0, 1.0);
}
// Only at one end.
double tip(const Vec3& x) {
  return x.x > 0.9 ? 1 : 0;
}

Mesh two_colors(CellType type = CellType::tet4) {
  return painted(painted(test::box({6, 3, 3}, {1, 1, 1}, type), "left", left), "right", right);
}

VolumeDef painted_zones(double compliance) {
  VolumeDef def;
  def.space = VolumeSpace::zone;
  for (const char* field : {"left", "right"}) {
    VolumeZone zone;
    zone.name = zone.field = field;
    zone.compliance = compliance;
    def.zones.push_back(zone);
  }
  return def;
}

std::string refusal(const Mesh& mesh, const VolumeDef& def) {
  WorldOptions options = test::static_options();
  options.solver = Solver::eigen;
  World world = test::make_world(options);
  test::add_body(world, mesh, Element::tet4, test::neo_hookean(1e5, 0.4));
  test::hold(world, BodyId{0}, {"x0"});
  auto added = world.add(volume(def));
  if (!added) return added.error();
  auto compiled = world.compile();
  return compiled ? "" : compiled.error();
}

}  // namespace

TEST_CASE("between two painted plates cells are projected straight up or down") {
  const std::vector<std::string> plates = {"z0", "z1"};
  for (const CellType type : {CellType::tet4, CellType::tet10, CellType::hex8}) {
    const Mesh mesh = test::box({3, 2, 8}, {1, 1, 1}, type);
    const SurfaceFeet feet = value(surface_feet(mesh, plates));
    CHECK(feet.lost == 0);
    double worst = 0;
    for (std::size_t c = 0; c < feet.cell.size(); ++c) {
      const Vec3 from = center_of(mesh, c), to = point_of(mesh, feet.cell[c]);
      worst = std::max({worst, std::abs(to.x - from.x), std::abs(to.y - from.y)});
      CHECK(to.z == Approx(from.z > 0.5 ? 1 : 0).margin(1e-12));
    }
    CHECK(worst < 1e-9);
    // Smooth distance: z (1 - z) / 2 has the normalized depth z near the plate.
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      const double z = mesh.nodes[n].z;
      if (feet.depth[n] > 0 && z < 0.3) CHECK(feet.depth[n] == Approx(z).epsilon(0.15));
    }
  }
}

TEST_CASE("in a cylinder cells are projected along its radii") {
  const Mesh mesh = test::scene_mesh("torsion_cylinder");
  const std::vector<std::string> side = {"side"};
  const SurfaceFeet feet = value(surface_feet(mesh, side));
  double turned = 0, risen = 0;
  for (std::size_t c = 0; c < feet.cell.size(); ++c) {
    const Vec3 from = center_of(mesh, c), to = point_of(mesh, feet.cell[c]);
    CHECK(std::hypot(to.x, to.y) > 0.95);
    risen = std::max(risen, std::abs(to.z - from.z));
    if (std::hypot(from.x, from.y) < 0.3) continue;  // the axis has no direction
    const double angle = std::atan2(from.x * to.y - from.y * to.x, from.x * to.x + from.y * to.y);
    turned = std::max(turned, std::abs(angle));
  }
  CHECK(feet.lost * 100 < static_cast<Index>(feet.cell.size()));
  CHECK(turned < 0.2);
  CHECK(risen < 0.2);
}

TEST_CASE("weights share cells, and add up to one at most") {
  const Mesh mesh = two_colors();
  const std::vector<std::string> fields = {"left", "right"};
  const PaintedCells p = value(painted_cells(mesh, fields));
  CHECK(p.painted == mesh.cell_count());
  CHECK(p.shared > 0);
  CHECK(p.shared < p.painted);
  CHECK(p.without == 0);
  for (std::size_t c = 0; c < p.weight[0].size(); ++c) {
    const double sum = p.weight[0][c] + p.weight[1][c];
    CHECK(sum < 1 + 1e-12);
    CHECK(sum > 0.99);  // the threshold takes traces away
    if (center_of(mesh, c).x < 0.1) CHECK(p.weight[0][c] == Approx(1));
    if (center_of(mesh, c).x > 0.9) CHECK(p.weight[1][c] == Approx(1));
  }
}

TEST_CASE("cells without paint stay without, or take the nearest zone, as asked") {
  const Mesh mesh = painted(
      painted(test::box({8, 2, 2}), "left", [](const Vec3& x) { return x.x < 0.2 ? 1.0 : 0.0; }), "tip", tip);
  const std::vector<std::string> fields = {"left", "tip"};
  const PaintedCells none = value(painted_cells(mesh, fields));
  CHECK(none.without > 0);
  CHECK(none.filled == 0);
  const PaintedCells nearest = value(painted_cells(mesh, fields, {}, UnpaintedCells::nearest));
  CHECK(nearest.without == 0);
  CHECK(nearest.filled == none.without);
  for (std::size_t c = 0; c < nearest.weight[0].size(); ++c) {
    const double x = center_of(mesh, c).x;
    if (x < 0.45) CHECK(nearest.weight[1][c] == 0);
    if (x > 0.7) CHECK(nearest.weight[0][c] == 0);
    CHECK(nearest.weight[0][c] + nearest.weight[1][c] > 0);
  }
}

TEST_CASE("painted hard zones keep their weighted volumes") {
  WorldOptions options = test::static_options();
  options.solver = Solver::eigen;
  const Mesh mesh = two_colors();
  const std::vector<std::string> fields = {"left", "right"};
  const PaintedCells paint = value(painted_cells(mesh, fields));
  World world = test::make_world(options);
  const BodyId body = test::add_body(world, mesh, Element::tet4, test::neo_hookean(1e5, 0.4));
  test::hold(world, body, {"x0"});
  VolumeDef base;
  base.space = VolumeSpace::element;
  value(world.add(volume(base)));
  VolumeDef zones = painted_zones(0);
  zones.name = "zones";
  zones.carries_bulk = false;
  value(world.add(volume(zones)));
  TractionDef pull;
  pull.body = body;
  pull.surface = "x1";
  pull.traction = {4e4, 0, 2e4};
  value(world.add(traction(pull)));
  test::must_advance(world);
  REQUIRE(world.warnings().size() == 1);
  CHECK_THAT(world.warnings()[0], ContainsSubstring("shared by several"));
  double before[3] = {}, after[3] = {};
  for (std::size_t c = 0; c < paint.weight[0].size(); ++c) {
    std::array<Vec3, 4> x, X;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto n = static_cast<std::size_t>(mesh.cells[4 * c + k]);
      x[k] = world.positions(body)[n];
      X[k] = mesh.nodes[n];
    }
    const double w[3] = {paint.weight[0][c], paint.weight[1][c], center_of(mesh, c).x < 0.3 ? 1.0 : 0.0};
    for (int z = 0; z < 3; ++z) {
      after[z] += w[z] * dot(x[1] - x[0], cross(x[2] - x[0], x[3] - x[0])) / 6;
      before[z] += w[z] * dot(X[1] - X[0], cross(X[2] - X[0], X[3] - X[0])) / 6;
    }
  }
  CHECK(after[0] == Approx(before[0]).epsilon(1e-9));
  CHECK(after[1] == Approx(before[1]).epsilon(1e-9));
  CHECK(std::abs(after[2] / before[2] - 1) > 1e-4);  // no zone of its own
}

TEST_CASE("painted compliant zones are as stiff in bulk as asked") {
  constexpr double s = 1e-5, young = 1e5, nu = 0.45;
  for (const Element element : {Element::tet4, Element::tet10, Element::hex8}) {
    WorldOptions options = test::static_options();
    options.solver = Solver::eigen;
    World world = test::make_world(options);
    const CellType type = element == Element::tet10  ? CellType::tet10
                          : element == Element::hex8 ? CellType::hex8
                                                     : CellType::tet4;
    const BodyId body = test::add_body(world, two_colors(type), element, test::neo_hookean(young, nu));
    test::move_linearly(world, body, {"x0", "x1", "y0", "y1", "z0", "z1"}, {},
                        [](const Vec3& p) { return s * p; });
    value(world.add(volume(painted_zones(1))));
    test::must_advance(world);
    const double bulk = young / (3 * (1 - 2 * nu));
    for (const double p : world.fields(body).cell_pressure) CHECK(p == Approx(3 * s * bulk).epsilon(1e-4));
  }
}

TEST_CASE("paint comes from the fields of mesh files, the same from Gmsh and VTK") {
  const Mesh gmsh = test::scene_mesh("arm");
  const std::vector<std::string> fields = {"upper", "lower"}, skin = {"skin"};
  const std::string path =
      (std::filesystem::temp_directory_path() / ("isochor_paint_" + std::to_string(getpid()) + ".vtu"))
          .string();
  VtkGrid grid;
  grid.points = gmsh.nodes;
  grid.cells = gmsh.cells;
  for (const MeshField& f : gmsh.fields) grid.point_fields.push_back({f.name, f.components, f.values});
  REQUIRE(write_vtu(path, grid).ok());
  const Mesh vtu = value(read_mesh(path));
  std::filesystem::remove(path);
  const PaintedCells a = value(painted_cells(gmsh, fields)), b = value(painted_cells(vtu, fields));
  CHECK(a.weight == b.weight);
  // With the bone and the ends left out of the surface, all cells are carried to the skin.
  for (const SurfaceFoot& foot : value(surface_feet(gmsh, skin)).cell) {
    const Vec3 p = point_of(gmsh, foot);
    CHECK(std::hypot(p.y, p.z) > 0.03);
  }
  const PaintedCells c = value(painted_cells(gmsh, fields, skin));
  CHECK(c.shared > 0);
  CHECK(c.without > 0);
  CHECK(c.lost * 100 < gmsh.cell_count());
  for (std::size_t k = 0; k < c.weight[0].size(); ++k) {
    const Vec3 x = center_of(gmsh, k);
    if (x.x > 0.06 && x.x < 0.14 && x.y > 0.012) CHECK(c.weight[0][k] > c.weight[1][k]);
    if (x.x > 0.06 && x.x < 0.14 && x.y < -0.012) CHECK(c.weight[1][k] > c.weight[0][k]);
  }
}

TEST_CASE("paint that means nothing is refused") {
  VolumeDef def = painted_zones(1);
  CHECK(refusal(two_colors(), def).empty());
  CHECK_THAT(refusal(test::box({2, 2, 2}), def), ContainsSubstring("no field \"left\""));
  def.zones[1].field = "tip";
  CHECK_THAT(refusal(painted(two_colors(), "tip", tip), def), ContainsSubstring("no compliant zone"));
  def.unpainted = UnpaintedCells::nearest;
  CHECK(refusal(painted(two_colors(), "tip", tip), def).empty());
  const Mesh wild = painted(two_colors(), "tip", [](const Vec3& x) { return x.x > 0.9 ? 255.0 : 0.0; });
  CHECK_THAT(refusal(wild, def), ContainsSubstring("is 255 at node"));
  const Mesh blank = painted(two_colors(), "tip", [](const Vec3&) { return 0.0; });
  CHECK_THAT(refusal(blank, def), ContainsSubstring("zone \"right\": it has no cells"));
  def.painted_surfaces = {"roof"};
  CHECK_THAT(refusal(two_colors(), def), ContainsSubstring("no surface \"roof\""));
  for (VolumeZone& z : def.zones) z.field.clear();
  CHECK_THAT(refusal(two_colors(), def), ContainsSubstring("for zones with a field"));
}
