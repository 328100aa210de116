// Thin bodies among other things: what they weigh and hold, what they are tied to, what touches them, and
// what is refused.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>

#include "support/sheets.h"

using namespace isochor;
using test::value;

namespace {

// A sphere of triangles: an octahedron whose edges are halved so many times.
Mesh sphere(int levels, double radius) {
  Mesh mesh;
  mesh.cell_type = CellType::tri3;
  mesh.nodes = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.cells = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<Index, Index>, Index> middle;
    std::vector<Index> finer;
    const auto between = [&](Index a, Index b) {
      const auto [it, fresh] = middle.try_emplace(std::minmax(a, b), mesh.node_count());
      if (fresh)
        mesh.nodes.push_back(
            0.5 * (mesh.nodes[static_cast<std::size_t>(a)] + mesh.nodes[static_cast<std::size_t>(b)]));
      return it->second;
    };
    for (std::size_t c = 0; c < mesh.cells.size(); c += 3) {
      const Index a = mesh.cells[c], b = mesh.cells[c + 1], d = mesh.cells[c + 2];
      const Index ab = between(a, b), bd = between(b, d), da = between(d, a);
      finer.insert(finer.end(), {a, ab, da, ab, b, bd, da, bd, d, ab, bd, da});
    }
    mesh.cells = finer;
  }
  for (Vec3& x : mesh.nodes) x = (radius / std::sqrt(dot(x, x))) * x;
  return mesh;
}

ShellDef sheet_of(BodyId body, double young = 1e6, double nu = 0.3, double thickness = 0.01) {
  ShellDef def;
  def.body = body;
  def.young = young;
  def.poisson = nu;
  def.thickness = thickness;
  def.density = 1000;
  return def;
}

Selection rim_of(BodyId body) {
  Selection rim;
  rim.body = body;
  constexpr double near = 1e-7;
  rim.boxes = {{Vec3{-9, -9, -9}, Vec3{near, 9, 9}},
               {Vec3{1 - near, -9, -9}, Vec3{9, 9, 9}},
               {Vec3{-9, -9, -9}, Vec3{9, near, 9}},
               {Vec3{-9, 1 - near, -9}, Vec3{9, 9, 9}}};
  return rim;
}

// Why a world with one sheet and this shell is refused.
std::string refusal(const std::function<void(ShellDef&)>& change, Mesh mesh = test::unit_sheet(2, 2)) {
  World world = test::make_world(test::dynamic_options());
  const BodyId body = test::add_sheet(world, std::move(mesh));
  ShellDef def = sheet_of(body);
  change(def);
  auto added = world.add(shell(def));
  if (!added) return added.error();
  auto compiled = world.compile();
  return compiled ? "" : compiled.error();
}

}  // namespace

TEST_CASE("a thin body weighs its area times its thickness and falls like anything else") {
  WorldOptions options = test::dynamic_options();
  options.gravity = {0, 0, -10};
  World world = test::make_world(options);
  const BodyId body = test::add_sheet(world, test::unit_sheet(3, 3, 0.2));
  value(world.add(shell(sheet_of(body))));
  for (int k = 0; k < 4; ++k) test::must_advance(world, 0.01);
  const BodyMeasures m = world.measures(body);
  CHECK(m.mass == Approx(1000 * 0.01).epsilon(1e-12));
  CHECK(m.linear_momentum.z == Approx(-10 * 10 * 0.04).epsilon(1e-9));
  CHECK(std::abs(m.angular_momentum.x - (-4 * 0.5)) < 1e-6);
  CHECK(test::gauge(world, "area") == Approx(1).epsilon(1e-9));
}

TEST_CASE("the weight of a held sheet is what its supports carry, in statics too") {
  WorldOptions options = test::static_options();
  options.gravity = {0, 0, -10};
  World world = test::make_world(options);
  const BodyId body = test::add_sheet(world, test::unit_sheet(6, 6));
  value(world.add(shell(sheet_of(body))));
  const EffectId rim = test::hold_nodes(world, "rim", rim_of(body), {});
  test::must_advance(world);
  CHECK(world.reaction(rim)[0].z == Approx(100).epsilon(1e-8));
}

TEST_CASE("a pressurized sphere grows as thin spheres do, and its gas and volume are those of a cavity") {
  const double R = 0.1, t = 1e-3, E = 1e6, nu = 0.3, p = 20;
  World world = test::make_world(test::static_options());
  const Mesh mesh = sphere(3, R);
  const BodyId body = test::add_sheet(world, mesh);
  value(world.add(shell(sheet_of(body, E, nu, t))));
  // Six directions at three nodes, which the pressure leaves without force.
  const auto at_node = [&](Index n) {
    Selection s;
    s.body = body;
    s.nodes = {n};
    return s;
  };
  test::hold_nodes(world, "a", at_node(0), {{0, 1, 0}, {0, 0, 1}});
  test::hold_nodes(world, "b", at_node(1), {{0, 1, 0}, {0, 0, 1}});
  test::hold_nodes(world, "c", at_node(2), {{1, 0, 0}, {0, 0, 1}});
  CavityDef air;
  air.body = body;
  air.surfaces = {"outer"};
  air.amount = Curve::ramp(p);
  value(world.add(cavity(air)));
  test::must_advance(world, 1e-9);
  const double before = test::gauge(world, "volume");
  CHECK(before == Approx(4.0 / 3 * std::numbers::pi * R * R * R).epsilon(0.03));
  test::must_advance(world, 1 - 1e-9);
  const double u = p * R * R * (1 - nu) / (2 * E * t);
  CHECK((test::gauge(world, "volume") - before) / (3 * before) == Approx(u / R).epsilon(0.03));
}

TEST_CASE("a sheet is tied to a solid, and a solid to a sheet") {
  for (const bool to_sheet : {false, true}) {
    WorldOptions options = test::static_options();
    options.gravity = {0, 0, -1};
    World world = test::make_world(options);
    const BodyId block = test::add_body(world, test::block({0.2, 0.2, 0}, {0.8, 0.8, 0.3}, {3, 3, 2}),
                                        Element::tet4, test::neo_hookean(1e5, 0.3), 100, "block");
    const BodyId body = test::add_sheet(world, test::unit_sheet(8, 8));
    ShellDef def = sheet_of(body);
    def.clamped = rim_of(body);
    value(world.add(shell(def)));
    TieDef bond;
    bond.where.body = to_sheet ? block : body;
    bond.to = to_sheet ? body : block;
    if (to_sheet)
      bond.where.surfaces = {"z0"};
    else
      bond.where.boxes = {{Vec3{0.2, 0.2, -1}, Vec3{0.8, 0.8, 1}}};
    value(world.add(tie(bond)));
    const EffectId rim = test::hold_nodes(world, "rim", rim_of(body), {});
    test::must_advance(world);
    INFO("to the sheet: " << to_sheet);
    CHECK(world.reaction(rim)[0].z == Approx(1000 * 0.01 + 0.6 * 0.6 * 0.3 * 100).epsilon(1e-8));
    const Vec3 sag = test::displacement_at(world, body, {0.5, 0.5, 0});
    const Vec3 above = test::displacement_at(world, block, {0.4, 0.4, 0.0});
    CHECK(sag.z < 0);
    CHECK(above.z < 0);
  }
}

TEST_CASE("a sheet is touched from both sides") {
  // A block that lies on it, and the same block pressed against it from below.
  double sag[2];
  for (const int side : {0, 1}) {
    const double up = side == 0 ? 1 : -1;
    WorldOptions options = test::static_options();
    World world = test::make_world(options);
    const double low = side == 0 ? 0.0 : -0.2;
    const BodyId block = test::add_body(world, test::block({0.3, 0.3, low}, {0.7, 0.7, low + 0.2}, {4, 4, 2}),
                                        Element::tet4, test::neo_hookean(1e5, 0.3), 100, "block");
    const BodyId body = test::add_sheet(world, test::unit_sheet(10, 10));
    ShellDef def = sheet_of(body, 1e7);
    def.clamped = rim_of(body);
    value(world.add(shell(def)));
    const EffectId rim = test::hold_nodes(world, "rim", rim_of(body), {});
    test::hold(world, block, {side == 0 ? "z1" : "z0"}, {}, {0, 0, -0.03 * up});
    SurfaceContactDef touch;
    touch.body = block;
    touch.against = body;
    value(world.add(surface_contact(touch)));
    for (int k = 0; k < 4; ++k) test::must_advance(world, 0.25);
    sag[side] = up * test::displacement_at(world, body, {0.5, 0.5, 0}).z;
    const double force = up * world.reaction(rim)[0].z;
    INFO("side " << side);
    CHECK(sag[side] < -1e-3);
    CHECK(force > 0);
    CHECK(std::abs(test::gauge(world, "force_z")) == Approx(force).epsilon(1e-6));
  }
  CHECK(sag[0] == Approx(sag[1]).epsilon(1e-3));
}

TEST_CASE("a sheet lies on the floor, whichever side is up") {
  for (const bool turned : {false, true}) {
    WorldOptions options = test::dynamic_options();
    options.gravity = {0, 0, -10};
    World world = test::make_world(options);
    Mesh mesh = test::mapped(test::unit_sheet(6, 6), [](const Vec3& p) { return Vec3{p.x, p.y, 0.001}; });
    if (turned)
      for (std::size_t c = 0; c < mesh.cells.size(); c += 3) std::swap(mesh.cells[c], mesh.cells[c + 1]);
    const BodyId body = test::add_sheet(world, mesh);
    value(world.add(shell(sheet_of(body))));
    ContactDef floor;
    floor.body = body;
    floor.obstacle.shape = ObstacleShape::plane;
    value(world.add(contact(floor)));
    for (int k = 0; k < 40; ++k) test::must_advance(world, 0.005);
    CHECK(std::abs(test::displacement_at(world, body, {0.5, 0.5, 0}).z + 0.001) < 1e-4);
  }
}

TEST_CASE("a sheet that is flat by itself springs back from a bent mesh") {
  // An arc of 0.3 rad, whose first triangles keep the direction in which their chord leaves the root.
  constexpr double turn = 0.3, height = (1 - 0.955336489) / turn;
  World world = test::make_world(test::static_options());
  const Mesh bent = test::mapped(test::unit_sheet(12, 1), [](const Vec3& p) {
    return Vec3{std::sin(turn * p.x) / turn, 0.1 * p.y, (1 - std::cos(turn * p.x)) / turn};
  });
  const BodyId body = test::add_sheet(world, bent);
  ShellDef def = sheet_of(body, 1e6, 0, 0.02);
  def.flat = true;
  def.clamped = test::in_box(body, {-1, -1, -1}, {1e-7, 1, 1});
  value(world.add(shell(def)));
  test::hold_nodes(world, "root", def.clamped, {});
  test::must_advance(world);
  const Vec3 end{std::sin(turn) / turn, 0, height};
  const Vec3 tip = end + test::displacement_at(world, body, end);
  const double chord = 0.5 * turn / 12;
  CHECK(tip.x == Approx(std::cos(chord)).epsilon(1e-3));
  CHECK(tip.z == Approx(std::sin(chord)).epsilon(0.05));
}

TEST_CASE("shells that mean nothing are refused with what, value and remedy") {
  CHECK(refusal([](ShellDef&) {}).empty());
  CHECK_THAT(refusal([](ShellDef& d) { d.thickness = 0; }), ContainsSubstring("thickness = 0 m"));
  CHECK_THAT(refusal([](ShellDef& d) { d.young = -1; }), ContainsSubstring("young = -1 Pa"));
  CHECK_THAT(refusal([](ShellDef& d) { d.poisson = 0.6; }), ContainsSubstring("poisson = 0.6"));
  CHECK_THAT(refusal([](ShellDef& d) { d.bending = -2; }), ContainsSubstring("bending = -2"));
  CHECK_THAT(refusal([](ShellDef& d) { d.density = 0; }), ContainsSubstring("give the density"));
  CHECK_THAT(refusal([](ShellDef& d) { d.clamped.nodes = {4}; }), ContainsSubstring("no edge of its rim"));
  CHECK_THAT(refusal([](ShellDef& d) { d.surfaces = {"top"}; }), ContainsSubstring("\"top\""));
  // A third face at an edge; a face that goes round the other way; a part without a shell.
  Mesh fin = test::unit_sheet(1, 1);
  fin.nodes.push_back({0.5, 0.5, 1});
  const Index a = fin.cells[0], b = fin.cells[2];
  fin.cells.insert(fin.cells.end(), {a, b, 4});
  CHECK_THAT(refusal([](ShellDef&) {}, fin), ContainsSubstring("belongs to 3 faces"));
  Mesh turned = test::unit_sheet(2, 2);
  std::swap(turned.cells[0], turned.cells[1]);
  {
    World world = test::make_world(test::dynamic_options());
    BodyDef def;
    def.mesh = turned;
    def.element = Element::tri3;
    CHECK_THAT(world.add_body(def).error(), ContainsSubstring("round the other way than a neighbor"));
    def.mesh = test::unit_sheet(2, 2);
    def.element = Element::tet4;
    CHECK_THAT(world.add_body(def).error(), ContainsSubstring("needs element \"tri3\""));
    def.element = Element::tri3;
    def.materials = {{"", test::neo_hookean(1, 0.3), 1}};
    CHECK_THAT(world.add_body(def).error(), ContainsSubstring("takes no materials"));
    def.mesh = test::box({1, 1, 1});
    def.materials.clear();
    CHECK_THAT(world.add_body(def).error(), ContainsSubstring("needs a mesh of triangles"));
    def.mesh = {};
    def.mesh.cell_type = CellType::tri3;
    CHECK_THAT(world.add_body(def).error(), ContainsSubstring("the mesh has no faces"));
  }
  Mesh parts = test::unit_sheet(2, 2);
  parts.surfaces.push_back({"half", {parts.cells.begin(), parts.cells.begin() + 6}});
  CHECK_THAT(refusal([](ShellDef& d) { d.surfaces = {"half"}; }, parts),
             ContainsSubstring("nodes are without a shell"));
}

TEST_CASE("what thin bodies cannot do is said by name") {
  const auto with = [](const std::function<EffectPtr(BodyId)>& effect) {
    World world = test::make_world(test::static_options());
    const BodyId body = test::add_sheet(world, test::unit_sheet(2, 2));
    value(world.add(shell(sheet_of(body))));
    test::hold_nodes(world, "rim", rim_of(body), {});
    auto added = world.add(effect(body));
    if (!added) return added.error();
    auto compiled = world.compile();
    return compiled ? std::string() : compiled.error();
  };
  CHECK_THAT(with([](BodyId body) {
               SurfaceContactDef def;
               def.body = body;
               return surface_contact(def);
             }),
             ContainsSubstring("cannot touch itself"));
  CHECK_THAT(with([](BodyId body) {
               VolumeDef def;
               def.body = body;
               return volume(def);
             }),
             ContainsSubstring("is thin and has no regions"));
  CHECK_THAT(with([](BodyId body) {
               CavityDef def;
               def.body = body;
               def.surfaces = {"outer"};
               return cavity(def);
             }),
             ContainsSubstring("which side of them the chamber is on"));
  World bare = test::make_world(test::dynamic_options());
  test::add_sheet(bare, test::unit_sheet(2, 2));
  CHECK_THAT(bare.compile().error(), ContainsSubstring("no shell is on it"));
  World loose = test::make_world(test::static_options());
  value(loose.add(shell(sheet_of(test::add_sheet(loose, test::unit_sheet(2, 2))))));
  CHECK_THAT(loose.compile().error(), ContainsSubstring("nothing holds"));
}

TEST_CASE("sheets are read from files of triangles") {
  const auto folder = std::filesystem::temp_directory_path() / "isochor_sheets";
  std::filesystem::create_directories(folder);
  const auto write = [&](const char* name, const std::string& text) {
    std::ofstream(folder / name) << text;
    return (folder / name).string();
  };
  MeshReadOptions options;
  options.triangles = true;
  options.scale = 2;
  const Mesh obj =
      value(read_mesh(write("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"), options));
  CHECK(obj.cell_type == CellType::tri3);
  CHECK(obj.cell_count() == 2);
  CHECK(obj.nodes[2] == Vec3{2, 2, 0});
  const Mesh gmsh = value(read_mesh(
      write("a.msh",
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"left\"\n2 2 \"right\"\n"
            "$EndPhysicalNames\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n$Elements\n2\n"
            "1 2 2 2 1 1 2 3\n2 2 2 1 1 1 3 4\n$EndElements\n"),
      options));
  CHECK(gmsh.cell_count() == 2);
  REQUIRE(gmsh.surfaces.size() == 2);
  CHECK(gmsh.surfaces[0].name == "left");
  CHECK(gmsh.surfaces[0].faces.size() == 3);
  CHECK(check_mesh(gmsh).usable());
  // Without the option a file of triangles is no body.
  CHECK_FALSE(read_mesh((folder / "a.msh").string()).ok());
  std::filesystem::remove_all(folder);
}

TEST_CASE("every method ends at the same deflection") {
  double first = 0;
  for (const Method method : {Method::saddle_point, Method::condensation, Method::dual_gradients,
                              Method::augmented_gradients, Method::augmented_ascent}) {
    WorldOptions options = test::static_options();
    options.gravity = {0, 0, -10};
    options.method = method;
    options.max_iterations = 2000;
    World world = test::make_world(options);
    const BodyId body = test::add_sheet(world, test::unit_sheet(6, 6, 0.2));
    ShellDef def = sheet_of(body, 1e8, 0.3, 0.02);
    def.clamped = rim_of(body);
    value(world.add(shell(def)));
    test::hold_nodes(world, "rim", rim_of(body), {});
    test::must_advance(world);
    const double sag = test::displacement_at(world, body, {0.5, 0.5, 0}).z;
    INFO("method " << static_cast<int>(method));
    if (first == 0) first = sag;
    CHECK(sag < -1e-4);
    CHECK(sag == Approx(first).epsilon(1e-5));
  }
}
