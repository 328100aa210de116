// Faces and nodes by where they are, and the names that the boundary has by itself.
#include "isochor/mesh_select.h"

#include <numbers>
#include <set>

#include "isochor/generate.h"
#include "mesh_support.h"

using namespace mesh_test;
using isochor::MeshSelection;

namespace {

constexpr CellType kTypes[] = {CellType::tet4, CellType::tet10, CellType::hex8};

Mesh box(CellType type, std::array<int, 3> divisions = {4, 3, 5}) {
  isochor::BoxMeshDef def;
  def.upper = {0.4, 0.3, 0.5};
  def.divisions = divisions;
  def.cell_type = type;
  return std::move(isochor::box_mesh(def)).value();
}

// Without the cells whose middle is in one of the boxes; no groups are left.
Mesh without(const Mesh& from, const std::vector<std::array<Vec3, 2>>& boxes) {
  Mesh mesh;
  mesh.cell_type = from.cell_type;
  const auto width = static_cast<std::size_t>(nodes_per_cell(from.cell_type));
  std::vector<Index> place(from.nodes.size(), -1);
  for (std::size_t c = 0; c < from.cells.size(); c += width) {
    Vec3 middle{};
    const std::size_t corners = width == 8 ? 8 : 4;
    for (std::size_t k = 0; k < corners; ++k)
      middle += (1.0 / double(corners)) * from.nodes[std::size_t(from.cells[c + k])];
    const bool out = std::any_of(boxes.begin(), boxes.end(), [&](const auto& b) {
      return middle.x > b[0].x && middle.y > b[0].y && middle.z > b[0].z && middle.x < b[1].x &&
             middle.y < b[1].y && middle.z < b[1].z;
    });
    for (std::size_t k = 0; k < width && !out; ++k) {
      Index& p = place[std::size_t(from.cells[c + k])];
      if (p < 0) {
        p = mesh.node_count();
        mesh.nodes.push_back(from.nodes[std::size_t(from.cells[c + k])]);
      }
      mesh.cells.push_back(p);
    }
  }
  return mesh;
}

using Key = std::vector<Index>;
std::set<Key> keys(const Mesh& mesh, const std::vector<Index>& faces) {
  const auto width = static_cast<std::size_t>(nodes_per_face(mesh.cell_type));
  std::set<Key> out;
  for (std::size_t f = 0; f < faces.size(); f += width) {
    Key key(faces.begin() + std::ptrdiff_t(f), faces.begin() + std::ptrdiff_t(f + width));
    std::sort(key.begin(), key.end());
    out.insert(key);
  }
  return out;
}

std::vector<Index> chosen(const Mesh& mesh, const MeshSelection& s) {
  auto r = isochor::select_faces(mesh, s);
  INFO((r ? std::string() : r.error()));
  REQUIRE(r.ok());
  return std::move(r).value();
}

const std::vector<Index>& named(const Mesh& mesh, const std::string& name) {
  for (const auto& s : mesh.surfaces) {
    if (s.name == name) return s.faces;
  }
  FAIL("no surface " << name);
  return mesh.surfaces[0].faces;
}

}  // namespace

TEST_CASE("selection: every criterion finds the sides of a box", "[mesh]") {
  for (const CellType type : kTypes) {
    const Mesh mesh = box(type);
    MeshSelection plane, inside, facing, seed, file;
    plane.plane = {{{0.1, 0.2, 0.5}, {0, 0, 3}}};
    inside.box = {{{-1, -1, 0.49}, {1, 1, 1}}};
    facing.facing = {{{0.1, 0.1, 2}}};
    seed.seed = {{{0.2, 0.15, 0.6}}};
    file.lies_on = {{{{0, 0, 0.5}, {0.4, 0, 0.5}, {0.4, 0.3, 0.5}, {0, 0.3, 0.5}}, {0, 1, 2, 0, 2, 3}}};
    for (MeshSelection* s : {&plane, &inside, &facing, &seed, &file}) {
      CHECK(keys(mesh, chosen(mesh, *s)) == keys(mesh, named(mesh, "z1")));
      // All criteria must hold; and those of a surface.
      s->of = {"x0"};
      const auto none = isochor::select_faces(mesh, *s);
      if (s == &seed)
        CHECK(keys(mesh, none.value()) == keys(mesh, named(mesh, "x0")));
      else
        CHECK_FALSE(none.ok());
    }
    MeshSelection ball;
    ball.sphere = {{{0.4, 0.3, 0.5}, 0.3}};
    const std::vector<Index> faces = chosen(mesh, ball);
    std::set<Index> on_faces(faces.begin(), faces.end());
    for (const Index n : on_faces) {
      const Vec3 d = mesh.nodes[std::size_t(n)] - Vec3{0.4, 0.3, 0.5};
      CHECK(std::sqrt(dot(d, d)) < 0.3 + 1e-5);
    }
    CHECK(on_faces.size() > 6);
  }
}

TEST_CASE("selection: nodes, inside the body as well", "[mesh]") {
  const Mesh mesh = box(CellType::tet4, {4, 4, 4});
  MeshSelection middle;
  middle.name = "middle";
  middle.plane = {{{0.2, 0, 0}, {1, 0, 0}}};
  CHECK(isochor::select_nodes(mesh, middle).value().size() == 25);
  CHECK_FALSE(isochor::select_faces(mesh, middle).ok());
  middle.of = {"z1"};
  middle.plane.reset();
  CHECK(isochor::select_nodes(mesh, middle).value().size() == 25);
  Mesh more = mesh;
  CHECK(isochor::add_node_set(more, middle).ok());
  CHECK(mentions(isochor::add_node_set(more, middle).error(), {"middle", "node set of this name"}));
  middle.name = "z0";
  CHECK(mentions(isochor::add_surface(more, middle).error(), {"z0", "surface of this name"}));
}

TEST_CASE("selection: a seed stops at edges, round walls are one surface", "[mesh]") {
  // A box bent to a quarter of a ring: its round sides turn by 11 degrees from face to face, its edges by 90.
  for (const CellType type : kTypes) {
    Mesh mesh = box(type, {8, 2, 2});
    for (Vec3& x : mesh.nodes) {
      const double angle = x.x / 0.4 * std::numbers::pi / 2, r = 1 + x.y;
      x = {r * std::sin(angle), r * std::cos(angle), x.z};
    }
    MeshSelection seed;
    seed.seed = {{{0.9, 0.9, 0.2}, 0.4}};
    const Vec3 outer{1.3 * std::sqrt(0.5), 1.3 * std::sqrt(0.5), 0.2};
    seed.seed->point = outer;
    CHECK(keys(mesh, chosen(mesh, seed)) == keys(mesh, named(mesh, "y1")));
    seed.seed->angle = 0.05;
    CHECK(keys(mesh, chosen(mesh, seed)).size() < keys(mesh, named(mesh, "y1")).size());
    seed.seed->angle = 3.1;
    CHECK(keys(mesh, chosen(mesh, seed)).size() > keys(mesh, named(mesh, "y1")).size());
  }
}

TEST_CASE("boundary: outer and chambers have names, sizes and all faces", "[mesh]") {
  for (const CellType type : kTypes) {
    Mesh mesh = without(box(type, {8, 6, 10}), {{Vec3{0.1, 0.1, 0.1}, Vec3{0.2, 0.2, 0.2}},
                                                {Vec3{0.1, 0.1, 0.3}, Vec3{0.3, 0.2, 0.4}}});
    const MeshReport report = isochor::check_mesh(mesh);
    REQUIRE(report.boundary.size() == 3);
    CHECK(report.boundary[0].surface.name == "outer");
    CHECK(report.boundary[0].volume == Approx(0.06).epsilon(1e-12));
    std::vector<double> volumes = {report.boundary[1].volume, report.boundary[2].volume};
    std::sort(volumes.begin(), volumes.end());
    CHECK(volumes[0] == Approx(0.001).epsilon(1e-10));
    CHECK(volumes[1] == Approx(0.002).epsilon(1e-10));
    CHECK(mentions(find(report, "cavity")->message, {"\"chamber 1\"", "\"chamber 2\""}));
    // Together they are the boundary, and a selection can start from them.
    std::size_t faces = 0;
    for (const auto& part : report.boundary) faces += keys(mesh, part.surface.faces).size();
    MeshSelection all;
    all.facing = {{{0, 0, 1}, std::numbers::pi}};
    CHECK(keys(mesh, chosen(mesh, all)).size() == faces);
    MeshSelection floor;
    floor.of = {"chamber 1"};
    CHECK(keys(mesh, chosen(mesh, floor)) == keys(mesh, report.boundary[1].surface.faces));
    floor.facing = {{{0, 0, 1}}};
    CHECK(keys(mesh, chosen(mesh, floor)).size() < keys(mesh, report.boundary[1].surface.faces).size());
    floor.of = {"chamber 7"};
    CHECK(mentions(isochor::select_faces(mesh, floor).error(),
                   {"chamber 7", "\"outer\", \"chamber 1\", \"chamber 2\""}));
    mesh.surfaces.push_back({"chamber 2", report.boundary[0].surface.faces});
    CHECK(isochor::check_mesh(mesh).boundary[2].taken);
    CHECK_FALSE(isochor::check_mesh(mesh).boundary[1].taken);
  }
}

TEST_CASE("selection: what contradicts itself is refused with the number", "[mesh]") {
  const Mesh mesh = box(CellType::tet4);
  const auto refused = [&](const MeshSelection& s, const std::vector<std::string>& says) {
    const auto r = isochor::select_faces(mesh, s);
    REQUIRE_FALSE(r.ok());
    CHECK(mentions(r.error(), says));
  };
  MeshSelection s;
  s.name = "top";
  refused(s, {"top", "nothing says"});
  s.box = {{{0, 0, 1}, {1, 1, 0}}};
  refused(s, {"from 1 to 0", "along z"});
  s.box = {{{5, 5, 5}, {6, 6, 6}}};
  refused(s, {"no boundary face", "tolerance"});
  s.box = {{{5, 5, 5}, {6, 6, std::nan("")}}};
  refused(s, {"finite"});
  s.box.reset();
  s.plane = {{{}, {}}};
  refused(s, {"normal"});
  s.plane.reset();
  s.sphere = {{{}, -1}};
  refused(s, {"radius is -1"});
  s.sphere.reset();
  s.seed = {{{}, 0}};
  refused(s, {"angle 0"});
  s.seed->angle = 0.5;
  s.tolerance = -1;
  refused(s, {"tolerance = -1"});
  Mesh broken = mesh;
  broken.cells[0] = 99999;
  s.tolerance = 0;
  CHECK_FALSE(isochor::select_faces(broken, s).ok());
}
