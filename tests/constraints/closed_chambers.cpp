// A chamber is closed where the oriented edges of its faces cancel: also where voids meet in edges and
// corners, and where faces are listed twice.
#include <random>
#include <set>

#include "isochor/mesh_select.h"
#include "support/worlds.h"

using namespace isochor;
using namespace test;

namespace {

constexpr int kSide = 6;
constexpr double kCell = 0.01;

std::size_t index(Index i) {
  return static_cast<std::size_t>(i);
}

using Voxel = std::array<int, 3>;

// Voxels inside the block, none at its border: some at random, and one that touches another in an edge only.
std::set<Voxel> random_voids(std::mt19937& random) {
  std::set<Voxel> voids;
  const auto inside = [&] { return 1 + static_cast<int>(random() % (kSide - 2)); };
  for (auto k = 3 + random() % 5; k > 0; --k) voids.insert({inside(), inside(), inside()});
  voids.insert({2, 2, 3});
  voids.insert({3, 3, 3});
  voids.erase({2, 3, 3});
  voids.erase({3, 2, 3});
  return voids;
}

Mesh block_without(const std::set<Voxel>& voids, CellType type) {
  const double size = kSide * kCell;
  const Mesh whole = block({0, 0, 0}, {size, size, size}, {kSide, kSide, kSide}, type);
  const auto per = static_cast<std::size_t>(nodes_per_cell(type));
  Mesh mesh;
  mesh.cell_type = type;
  std::vector<Index> place(whole.nodes.size(), -1);
  for (std::size_t c = 0; c < whole.cells.size(); c += per) {
    Vec3 middle{};
    const std::size_t corners = per == 8 ? 8 : 4;
    for (std::size_t k = 0; k < corners; ++k)
      middle += (1.0 / double(corners) / kCell) * whole.nodes[index(whole.cells[c + k])];
    if (voids.count({int(middle.x), int(middle.y), int(middle.z)}) > 0) continue;
    for (std::size_t k = 0; k < per; ++k) {
      Index& p = place[index(whole.cells[c + k])];
      if (p < 0) {
        p = mesh.node_count();
        mesh.nodes.push_back(whole.nodes[index(whole.cells[c + k])]);
      }
      mesh.cells.push_back(p);
    }
  }
  return mesh;
}

}  // namespace

TEST_CASE("chambers that meet in edges and corners are closed") {
  std::mt19937 random(8);
  int crowded = 0;
  for (const CellType type : {CellType::tet4, CellType::tet10, CellType::hex8}) {
    const Element element = type == CellType::tet4    ? Element::tet4
                            : type == CellType::tet10 ? Element::tet10
                                                      : Element::hex8;
    for (int round = 0; round < 8; ++round) {
      const std::set<Voxel> voids = random_voids(random);
      CAPTURE(name_of(element), round, voids.size());
      Mesh mesh = block_without(voids, type);
      const MeshReport report = check_mesh(mesh);
      if (report.parts > 1) continue;
      for (const MeshFinding& f : report.findings) crowded += f.code == "non-manifold-edge";
      // All chambers as one group that lists every third face twice.
      MeshSurface group{"group", {}};
      const auto per = static_cast<std::size_t>(nodes_per_face(type));
      CavityDef by_name, by_group;
      for (std::size_t p = 1; p < report.boundary.size(); ++p) {
        by_name.surfaces.push_back(report.boundary[p].surface.name);
        const auto& faces = report.boundary[p].surface.faces;
        for (std::size_t f = 0; f < faces.size(); f += per) {
          for (std::size_t copy = 0; copy < (f / per % 3 == 0 ? 2 : 1); ++copy)
            group.faces.insert(group.faces.end(), &faces[f], &faces[f] + per);
        }
      }
      mesh.surfaces.push_back(group);
      by_group.name = "twice";
      by_group.surfaces = {"group", by_name.surfaces[0], "group"};
      MeshSelection floor;
      floor.name = "floor";
      floor.plane = {{{}, {0, 0, 1}}};
      REQUIRE(add_surface(mesh, floor).ok());
      World world = make_world(static_options());
      const BodyId body = add_body(world, mesh, element, neo_hookean(1e5, 0.3));
      hold(world, body, {"floor"});
      value(world.add(cavity(by_name)));
      value(world.add(cavity(by_group)));
      const auto compiled = world.compile();
      INFO((compiled ? std::string() : compiled.error()));
      REQUIRE(compiled.ok());
      int seen = 0;
      for (const Gauge& g : world.gauges()) {
        if (g.quantity != "volume") continue;
        ++seen;
        CHECK(g.value == Approx(double(voids.size()) * kCell * kCell * kCell).epsilon(1e-10));
      }
      CHECK(seen == 2);
    }
  }
  CHECK(crowded > 8);
}

TEST_CASE("a face that is named twice counts once, whatever acts on it") {
  const auto tip = [](std::vector<std::string> surfaces, int copies) {
    World world = make_world(static_options());
    Mesh mesh = block({0, 0, 0}, {0.1, 0.02, 0.02}, {5, 1, 1});
    for (MeshSurface& s : mesh.surfaces) {
      const auto once = s.faces;
      for (int k = 1; k < copies; ++k) s.faces.insert(s.faces.end(), once.begin(), once.end());
    }
    const BodyId body = add_body(world, mesh, Element::tet4, neo_hookean(1e5, 0.3));
    hold(world, body, {"x0"});
    TractionDef load;
    load.surface = "z1";
    load.traction = {0, 0, -50};
    value(world.add(traction(load)));
    PressureDef press;
    press.surfaces = surfaces;
    press.amount = Curve::constant(20);
    value(world.add(pressure(press)));
    MembraneDef skin;
    skin.surfaces = surfaces;
    skin.young = 1e6;
    skin.thickness = 1e-4;
    value(world.add(membrane(skin)));
    must_advance(world);
    return displacement_at(world, body, {0.1, 0.01, 0.01});
  };
  const Vec3 once = tip({"z1", "y1"}, 1);
  CHECK(dot(once, once) > 0);
  for (const Vec3& other : {tip({"z1", "y1", "z1"}, 1), tip({"z1", "y1"}, 2), tip({"y1", "z1", "y1"}, 3)}) {
    const Vec3 d = other - once;
    CHECK(std::sqrt(dot(d, d)) < 1e-8 * std::sqrt(dot(once, once)));
  }
}
