// What a host can get wrong, and the sentence it gets: what, where, which value, what to do.
#include <cmath>

#include "support/worlds.h"

using namespace isochor;
using namespace test;

namespace {

std::string refusal(const Result<void>& r) {
  return r ? std::string("accepted") : r.error();
}
template <class T>
std::string refusal(const Result<T>& r) {
  return r ? std::string("accepted") : r.error();
}

// A world with one cube; what is added decides.
struct Draft {
  World world;
  BodyId body{};

  explicit Draft(double poisson = 0.5, Element element = Element::tet4,
                 WorldOptions options = static_options(), Mesh mesh = box({2, 2, 2}))
      : world(make_world(options)) {
    body = add_body(world, std::move(mesh), element, neo_hookean(1e5, poisson));
  }
  std::string add_volume_rows(VolumeSpace space, bool carries_bulk, std::string name) {
    VolumeDef def;
    def.name = std::move(name);
    def.space = space;
    def.carries_bulk = carries_bulk;
    def.hard = !carries_bulk;
    return refusal(world.add(isochor::volume(def)));
  }
  std::string compiled() { return refusal(world.compile()); }
};

}  // namespace

TEST_CASE("statics refuses a body that nothing holds, dynamics does not") {
  Draft loose;
  add_volume(loose.world, loose.body);
  CHECK_THAT(loose.compiled(), ContainsSubstring("\"body\"") && ContainsSubstring("nothing holds") &&
                                   ContainsSubstring("translation along x") &&
                                   ContainsSubstring("rotation") && ContainsSubstring("dirichlet"));
  CHECK(loose.world.step(1).status == StepStatus::invalid);
  Draft sliding;
  add_volume(sliding.world, sliding.body);
  hold(sliding.world, sliding.body, {"x0"}, {{1, 0, 0}});
  CHECK_THAT(sliding.compiled(),
             ContainsSubstring("translation along y") && !ContainsSubstring("translation along x"));
  Draft moving(0.5, Element::tet4, dynamic_options());
  add_volume(moving.world, moving.body);
  CHECK(moving.compiled() == "accepted");
}

TEST_CASE("names that do not exist are answered with those that do") {
  Draft d;
  add_volume(d.world, d.body);
  hold(d.world, d.body, {"ceiling"});
  CHECK_THAT(d.compiled(), ContainsSubstring("ceiling") && ContainsSubstring("surface") &&
                               ContainsSubstring("\"x0\"") && ContainsSubstring("\"z1\"") &&
                               ContainsSubstring("hold"));
  Draft region;
  VolumeDef v;
  v.regions = {"heart"};
  value(region.world.add(isochor::volume(v)));
  CHECK_THAT(region.compiled(),
             ContainsSubstring("heart") && ContainsSubstring("region") && ContainsSubstring("\"body\""));
  Draft node_set;
  DirichletDef s;
  s.where.node_sets = {"rim"};
  value(node_set.world.add(dirichlet(s)));
  add_volume(node_set.world, node_set.body);
  CHECK_THAT(node_set.compiled(), ContainsSubstring("rim") && ContainsSubstring("node set"));
  Draft node;
  DirichletDef n;
  n.where.nodes = {4711};
  value(node.world.add(dirichlet(n)));
  add_volume(node.world, node.body);
  CHECK_THAT(node.compiled(), ContainsSubstring("4711") && ContainsSubstring("0 to 26"));
  Draft nobody;
  VolumeDef elsewhere;
  elsewhere.body = BodyId{7};
  value(nobody.world.add(isochor::volume(elsewhere)));
  CHECK_THAT(nobody.compiled(), ContainsSubstring("no body number 7"));
  Draft nothing;
  value(nothing.world.add(dirichlet({})));
  add_volume(nothing.world, nothing.body);
  CHECK_THAT(nothing.compiled(), ContainsSubstring("no nodes"));
}

TEST_CASE("materials of regions are checked") {
  World world = make_world(static_options());
  BodyDef def;
  def.mesh = divided(box({2, 1, 1}), 0.5);
  def.materials = {{"low", neo_hookean(1, 0.3), 1000}};
  CHECK_THAT(refusal(world.add_body(def)), ContainsSubstring("high") && ContainsSubstring("no material"));
  def.materials = {{"", neo_hookean(1, 0.3), 1000}, {"middle", neo_hookean(1, 0.3), 1000}};
  CHECK_THAT(refusal(world.add_body(def)),
             ContainsSubstring("middle") && ContainsSubstring("\"low\"") && ContainsSubstring("\"high\""));
  def.materials = {{"", nullptr, 1000}};
  CHECK_THAT(refusal(world.add_body(def)), ContainsSubstring("material is empty"));
  for (const double density : {0.0, -5.0, std::nan("")}) {
    def.materials = {{"", neo_hookean(1, 0.3), density}};
    CHECK_THAT(refusal(world.add_body(def)), ContainsSubstring("density") && ContainsSubstring("positive"));
  }
  def.materials = {{"", neo_hookean(1, 0.3), 1000}};
  CHECK(world.add_body(def).ok());
  CHECK_THAT(refusal(world.add_body(def)), ContainsSubstring("another body has this name"));
}

TEST_CASE("meshes are checked") {
  World world = make_world(static_options());
  BodyDef def;
  def.materials = {{"", neo_hookean(1, 0.3), 1000}};
  def.mesh = box({1, 1, 1});
  std::swap(def.mesh.cells[0], def.mesh.cells[1]);
  const std::string inverted = refusal(world.add_body(def));
  CHECK_THAT(inverted, ContainsSubstring("body \"body\"") && ContainsSubstring("invert"));
  def.mesh = box({1, 1, 1});
  def.mesh.nodes[static_cast<std::size_t>(def.mesh.cells[3])] =
      def.mesh.nodes[static_cast<std::size_t>(def.mesh.cells[2])];
  CHECK(refusal(world.add_body(def)) != "accepted");
  def.mesh = box({1, 1, 1});
  def.mesh.nodes[2].x = std::nan("");
  CHECK(refusal(world.add_body(def)) != "accepted");
  def.mesh = box({1, 1, 1});
  def.mesh.cells[5] = 99;
  CHECK(refusal(world.add_body(def)) != "accepted");
  def.mesh = Mesh{};
  CHECK(refusal(world.add_body(def)) != "accepted");
  def.mesh = box({1, 1, 1}, {1, 1, 1}, CellType::tet10);
  def.element = Element::tet4;
  CHECK_THAT(refusal(world.add_body(def)), ContainsSubstring("Tet10") && ContainsSubstring("tet10"));
}

TEST_CASE("nu = 0.5 without rows is refused with the remedy") {
  Draft d(0.5);
  hold(d.world, d.body, {"x0"});
  CHECK_THAT(d.compiled(), ContainsSubstring("\"body\"") && ContainsSubstring("0.5") &&
                               ContainsSubstring("one-field") && ContainsSubstring("volume rows"));
}

TEST_CASE("hard rows that lock, repeat or contradict each other are named") {
  Draft per_element(0.5, Element::tet4, static_options(), box({3, 3, 3}));
  CHECK(per_element.add_volume_rows(VolumeSpace::element, true, "incompressible") == "accepted");
  hold(per_element.world, per_element.body, {"x0"});
  CHECK_THAT(per_element.compiled(), ContainsSubstring("162") && ContainsSubstring("incompressible") &&
                                         ContainsSubstring("free displacements") &&
                                         ContainsSubstring("rows per node"));

  Draft twice(0.5);
  CHECK(twice.add_volume_rows(VolumeSpace::node, true, "nodal") == "accepted");
  CHECK(twice.add_volume_rows(VolumeSpace::body, false, "whole") == "accepted");
  hold(twice.world, twice.body, {"x0"});
  CHECK_THAT(twice.compiled(),
             ContainsSubstring("nodal") && ContainsSubstring("whole") && ContainsSubstring("drop one"));

  Draft bulk_twice(0.4);
  CHECK(bulk_twice.add_volume_rows(VolumeSpace::node, true, "first") == "accepted");
  CHECK(bulk_twice.add_volume_rows(VolumeSpace::body, true, "second") == "accepted");
  hold(bulk_twice.world, bulk_twice.body, {"x0"});
  CHECK_THAT(bulk_twice.compiled(), ContainsSubstring("second") && ContainsSubstring("carries_bulk"));

  Draft enclosed(0.5);
  add_volume(enclosed.world, enclosed.body);
  hold(enclosed.world, enclosed.body, {"x0", "x1", "y0", "y1", "z0", "z1"});
  CHECK_THAT(enclosed.compiled(),
             ContainsSubstring("\"body\"") && ContainsSubstring("enclosed") && ContainsSubstring("nu < 0.5"));
}

TEST_CASE("supports that contradict each other are named") {
  Draft d;
  add_volume(d.world, d.body);
  hold(d.world, d.body, {"x0"});
  hold(d.world, d.body, {"y0"}, {}, {0, 0, 0.1});
  CHECK_THAT(d.compiled(), ContainsSubstring("hold y0") && ContainsSubstring("hold x0") &&
                               ContainsSubstring("node") && ContainsSubstring("disjoint"));
  // The same motion twice is no contradiction.
  Draft same;
  add_volume(same.world, same.body);
  hold(same.world, same.body, {"x0"});
  hold(same.world, same.body, {"y0"});
  CHECK(same.compiled() == "accepted");
}

TEST_CASE("cavities are checked") {
  const auto draft = [](bool open) {
    return Draft(0.3, Element::tet4, static_options(), hollow_box(open, CellType::tet4));
  };
  CavityDef def;
  def.surfaces = {"chamber"};
  Draft open = draft(true);
  hold(open.world, open.body, {"z0"});
  value(open.world.add(cavity(def)));
  CHECK_THAT(open.compiled(), ContainsSubstring("cavity") && ContainsSubstring("opening") &&
                                  ContainsSubstring("node") && ContainsSubstring("cap_free_openings"));
  Draft closed = draft(false);
  hold(closed.world, closed.body, {"z0"});
  value(closed.world.add(cavity(def)));
  CHECK(closed.compiled() == "accepted");
  Draft wrong = draft(false);
  CavityDef outside = def;
  outside.surfaces = {"hull"};
  hold(wrong.world, wrong.body, {"z0"});
  value(wrong.world.add(cavity(outside)));
  CHECK_THAT(wrong.compiled(), ContainsSubstring("hull") && ContainsSubstring("\"chamber\""));
  Draft none = draft(false);
  CavityDef unnamed;
  CHECK_THAT(refusal(none.world.add(cavity(unnamed))), ContainsSubstring("no surface"));
  def.amount = Curve::constant(std::nan(""));
  CHECK_THAT(refusal(none.world.add(cavity(def))), ContainsSubstring("no number"));
  def.amount = Curve::constant(-2);
  def.control = CavityControl::volume;
  CHECK_THAT(refusal(none.world.add(cavity(def))), ContainsSubstring("-2") && ContainsSubstring("positive"));
}

TEST_CASE("loads and supports are checked") {
  Draft d;
  const double nan = std::nan("");
  TractionDef both;
  both.traction = {1, 0, 0};
  both.total_force = {1, 0, 0};
  CHECK_THAT(refusal(d.world.add(traction(both))),
             ContainsSubstring("both") && ContainsSubstring("give one"));
  both.total_force = {nan, 0, 0};
  CHECK_THAT(refusal(d.world.add(traction(both))), ContainsSubstring("finite"));
  PointForceDef force;
  force.force = {0, nan, 0};
  CHECK_THAT(refusal(d.world.add(point_force(force))), ContainsSubstring("finite"));
  DirichletDef support;
  support.directions = {{0, 0, 0}};
  CHECK_THAT(refusal(d.world.add(dirichlet(support))), ContainsSubstring("no length"));
  support.directions = {};
  support.angle = 1;
  CHECK_THAT(refusal(d.world.add(dirichlet(support))), ContainsSubstring("axis"));
  support.angle = nan;
  CHECK_THAT(refusal(d.world.add(dirichlet(support))), ContainsSubstring("finite"));
  VolumeDef rows;
  rows.stabilization = -1;
  CHECK_THAT(refusal(d.world.add(isochor::volume(rows))),
             ContainsSubstring("stabilization") && ContainsSubstring("-1"));
  CHECK_THAT(refusal(d.world.add(nullptr)), ContainsSubstring("empty effect"));
}

TEST_CASE("a world is checked") {
  CHECK_THAT(refusal(World::create(static_options(), kWorldAbi + 1)), ContainsSubstring("rebuild"));
  CHECK_THAT(refusal(World::create({})), ContainsSubstring("scheme"));
  WorldOptions options = static_options();
  options.force_tolerance = 0;
  CHECK_THAT(refusal(World::create(options)), ContainsSubstring("tolerances"));
  options = static_options();
  options.max_iterations = 0;
  CHECK_THAT(refusal(World::create(options)), ContainsSubstring("max_iterations"));
  options = static_options();
  options.threads = -1;
  CHECK_THAT(refusal(World::create(options)), ContainsSubstring("threads = -1"));
  options = static_options();
  options.gravity.y = std::nan("");
  CHECK_THAT(refusal(World::create(options)), ContainsSubstring("gravity"));
  World empty = make_world(static_options());
  CHECK_THAT(refusal(empty.compile()), ContainsSubstring("no body"));
  CHECK(empty.step(1).status == StepStatus::invalid);
}

TEST_CASE("what is added after the first step is checked, and so are amounts") {
  Draft d;
  add_volume(d.world, d.body);
  hold(d.world, d.body, {"x0"});
  REQUIRE(d.world.step(1).status == StepStatus::converged);
  value(d.world.add(isochor::volume({})));
  CHECK_THAT(refusal(d.world.compile()), ContainsSubstring("already carry the bulk modulus"));
  BodyDef late;
  late.name = "late";
  CHECK_THAT(refusal(d.world.add_body(late)), ContainsSubstring("late") && ContainsSubstring("no cells"));
  CHECK_THAT(refusal(d.world.set_amount(EffectId{9}, 1)), ContainsSubstring("no effect number 9"));
  CHECK_THAT(refusal(d.world.set_amount(EffectId{0}, 1)), ContainsSubstring("no amount"));
  CHECK_THAT(refusal(d.world.set_amount(EffectId{1}, std::nan(""))), ContainsSubstring("finite"));
  CHECK_THAT(refusal(d.world.set_amount(static_cast<EffectId>(-1), 1)),
             ContainsSubstring("no effect number -1"));
}

TEST_CASE("what a support holds, and the motions that it leaves") {
  const auto held_at = [](std::vector<Vec3> nearest, const Vec3& size) {
    Draft d(0.45, Element::tet4, static_options(), block({0, 0, 0}, size, {3, 2, 2}));
    DirichletDef def;
    def.name = "peg";
    def.where.nearest = std::move(nearest);
    value(d.world.add(dirichlet(def)));
    return d.compiled();
  };
  const std::string one = held_at({{0.3, 0.2, 0}}, {0.3, 0.2, 0.2});
  CHECK_THAT(one, ContainsSubstring("rotation about x, y and z through (0.3, 0.2, 0) m") &&
                      ContainsSubstring("support \"peg\" holds 1 node of it") &&
                      !ContainsSubstring("translation"));
  // Two nodes leave the line through them, whichever way it runs.
  const std::string two = held_at({{0, 0, 0}, {0.3, 0.2, 0}}, {0.3, 0.2, 0.2});
  CHECK_THAT(two,
             ContainsSubstring("holds 2 nodes") && ContainsSubstring("0.832") && ContainsSubstring("0.5547"));
  CHECK_THAT(held_at({{0, 0, 0}, {0, 0.2, 0}}, {0.3, 0.2, 0.2}),
             ContainsSubstring("against rotation about y through (0, ") && ContainsSubstring(", 0) m"));
  // The units are said once, by the message that ends the attempt.
  const std::string millimeters = held_at({{0, 0, 0}}, {120, 20, 20});
  const auto units = millimeters.find("scale 0.001");
  CHECK(units != std::string::npos);
  CHECK(millimeters.find("scale 0.001", units + 1) == std::string::npos);
  CHECK(held_at({{0, 0, 0}}, {0.3, 0.2, 0.2}).find("units") == std::string::npos);
}

TEST_CASE("of several parts the one that nothing holds is told by its place") {
  Mesh mesh = block({0, 0, 0}, {0.1, 0.1, 0.1}, {1, 1, 1});
  const Mesh far = block({0.5, 0, 0}, {0.7, 0.1, 0.1}, {2, 1, 1});
  const Index first = mesh.node_count();
  mesh.nodes.insert(mesh.nodes.end(), far.nodes.begin(), far.nodes.end());
  for (const Index n : far.cells) mesh.cells.push_back(first + n);
  Draft d(0.45, Element::tet4, static_options(), mesh);
  hold(d.world, d.body, {"x0"});
  CHECK_THAT(d.compiled(),
             ContainsSubstring("one of its parts (12 nodes from (0.5, 0, 0) to (0.7, 0.1, 0.1) m)") &&
                 ContainsSubstring("translation along x, y and z and rotation about x, y and z") &&
                 ContainsSubstring("no support holds a node of it"));
}

TEST_CASE("two materials for one region are refused by number and name") {
  const auto refused = [](std::vector<std::string> regions) {
    World world = make_world(static_options());
    BodyDef def;
    def.mesh = block({0, 0, 0}, {1, 1, 1}, {1, 1, 1});
    for (const std::string& region : regions) def.materials.push_back({region, neo_hookean(1e5, 0.45), 1000});
    return refusal(world.add_body(def));
  };
  CHECK_THAT(refused({"", ""}), ContainsSubstring("materials 0 and 1") && ContainsSubstring("all regions"));
  CHECK_THAT(refused({"", "body", "body"}),
             ContainsSubstring("materials 1 and 2") && ContainsSubstring("\"body\""));
  CHECK(refused({"", "body"}) == "accepted");
}

TEST_CASE("a mesh too large for memory is refused with its size before it is made") {
  BoxMeshDef def;
  def.divisions = {1000, 1000, 1000};
  for (const CellType type : {CellType::tet4, CellType::tet10, CellType::hex8}) {
    def.cell_type = type;
    const auto made = box_mesh(def);
    REQUIRE_FALSE(made.ok());
    CHECK_THAT(made.error(), ContainsSubstring("1000 x 1000 x 1000") || ContainsSubstring("1000000000"));
    CHECK_THAT(made.error(), ContainsSubstring("use"));
  }
}
