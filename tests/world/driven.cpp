// Given motion that is not rigid: nodes that follow data, bones that share nodes, an elbow that bends.
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "engine/base/base.h"
#include "numbers/cube.h"

using namespace isochor;
using test::value;

namespace {

// All nodes of the boundary of a block, at two frames of an affine map.
DrivenDef affine_data(const Mesh& mesh) {
  DrivenDef def;
  std::vector<bool> chosen(mesh.nodes.size(), false);
  for (const auto& s : mesh.surfaces) {
    for (const Index n : s.faces) chosen[static_cast<std::size_t>(n)] = true;
  }
  def.times = {0, 0.5, 1};
  def.positions.resize(3);
  for (std::size_t n = chosen.size(); n-- > 0;) {
    if (!chosen[n]) continue;
    const Vec3& X = mesh.nodes[n];
    def.nodes.push_back(static_cast<Index>(n));
    def.positions[0].push_back(X);
    def.positions[1].push_back({1.2 * X.x, X.y, X.z});
    def.positions[2].push_back({1.2 * X.x + 0.3 * X.y, X.y, 0.9 * X.z});
  }
  return def;
}

template <class Def, class Make>
std::string refusal(const Def& def, Make make) {
  World world = test::make_world(test::static_options());
  test::add_body(world, test::block({0, 0, 0}, {1, 1, 1}, {1, 1, 1}), Element::tet4,
                 test::neo_hookean(1e5, 0.3));
  auto added = world.add(make(def));
  if (!added) return added.error();
  const auto compiled = world.compile();
  return compiled ? "" : compiled.error();
}

// A limb along x with two flat bones in its middle, which meet at x = 0 and share what is close to the
// joint; the second turns about y.
struct Elbow {
  World world;
  BodyId body{};

  Elbow(Element element, const MaterialPtr& material, double angle, int fine = 1)
      : world(test::make_world(test::static_options())) {
    const CellType type = element == Element::hex8 ? CellType::hex8 : CellType::tet4;
    const Mesh mesh = test::block({-0.4, -0.1, -0.1}, {0.4, 0.1, 0.1}, {16 * fine, 4 * fine, 4 * fine}, type);
    body = test::add_body(world, mesh, element, material);
    test::add_volume(world, body);
    SkinDef def;
    def.where.body = body;
    def.where.boxes = {{Vec3{-1, -0.06, -0.03}, Vec3{1, 0.06, 0.03}}};
    def.bones.resize(2);
    for (const Vec3& X : mesh.nodes) {
      const double s = std::clamp(0.5 + X.x / 0.2, 0.0, 1.0);
      def.bones[0].weights.push_back(1 - s);
      def.bones[1].weights.push_back(s);
    }
    def.bones[0].track.keys = {{0, {0, 0, 0}, {1, 0, 0, 0}}};
    def.bones[1].track.keys = {{0, {0, 0, 0}, {1, 0, 0, 0}},
                               {1, {0, 0, 0}, {std::cos(angle / 2), 0, std::sin(angle / 2), 0}}};
    value(world.add(skin(def)));
  }
};

}  // namespace

TEST_CASE("nodes that follow data are where the data say, and the body in between") {
  for (const Element element : {Element::tet4_edge_smoothed, Element::hex8}) {
    World world = test::make_world(test::static_options());
    const Mesh mesh = test::uneven_cube(element == Element::hex8 ? CellType::hex8 : CellType::tet4);
    const BodyId body = test::add_body(world, mesh, element, test::neo_hookean(1e5, 0.3));
    DrivenDef def = affine_data(mesh);
    def.body = body;
    value(world.add(driven(def)));
    test::must_advance(world, 0.25);
    CHECK(test::distance_from(world, body, [](const Vec3& X) { return Vec3{1.1 * X.x, X.y, X.z}; }) < 1e-9);
    test::must_advance(world, 0.25);
    test::must_advance(world, 0.25);
    CHECK(test::distance_from(world, body, [](const Vec3& X) {
            return Vec3{1.2 * X.x + 0.15 * X.y, X.y, 0.95 * X.z};
          }) < 1e-9);
    test::must_advance(world, 1);
    CHECK(test::distance_from(world, body, [](const Vec3& X) {
            return Vec3{1.2 * X.x + 0.3 * X.y, X.y, 0.9 * X.z};
          }) < 1e-9);
  }
}

TEST_CASE("data are read from lines, frame after frame") {
  const std::string path =
      std::filesystem::temp_directory_path() / ("driven" + std::to_string(getpid()) + ".csv");
  const auto read = [&](const std::string& text) {
    std::ofstream(path) << text;
    return read_driven(path);
  };
  const DrivenDef def =
      value(read("t,node,x,y,z\n# first\n0,7,1,2,3\n0,3,4,5,6\n\n0.5 7 1 2 4\n0.5 3 4 5 7\r\n"));
  CHECK(def.nodes == std::vector<Index>{7, 3});
  CHECK(def.times == std::vector<double>{0, 0.5});
  CHECK(def.positions[1][1] == Vec3{4, 5, 7});
  const auto says = [&](const std::string& text, const std::string& what) {
    const auto got = read(text);
    REQUIRE_FALSE(got);
    INFO(got.error());
    CHECK(got.error().find(path) == 0);
    CHECK(got.error().find(what) != std::string::npos);
  };
  says("0,1,2,3\n", "line 1: \"0,1,2,3\"; expected the five numbers");
  says("0,1.5,2,3,4\n", "line 1: node = 1.5");
  says("0,1,0,0,0\n0,2,0,0,0\n1,2,0,0,0\n", "line 3: node 2 at time 1 is out of its place");
  says("0,1,0,0,0\n0,2,0,0,0\n1,1,0,0,0\n", "positions[1] has 1 entries, nodes 2");
  says("1,1,0,0,0\n0,1,0,0,0\n", "times[1] = 0 does not come after 1");
  says("0,1,0,0,0\n0,1,0,0,0\n", "node 1 is listed twice");
  says("", "it has no nodes");
  std::filesystem::remove(path);
  CHECK(read_driven("/no/such/file").error().find("cannot be read") != std::string::npos);
}

TEST_CASE("an elbow bends about shared bones: volume kept, nothing turned over, any Poisson's ratio") {
  constexpr double right_angle = std::numbers::pi / 2;
  for (const Element element : {Element::tet4_edge_smoothed, Element::hex8}) {
    for (const bool stable : {true, false}) {
      for (const double poisson : {0.3, 0.45, 0.49, 0.4999, 0.5}) {
        ElasticConstants c;
        c.young = 1e5;
        c.poisson = poisson;
        Elbow elbow(element, value(stable ? stable_neo_hookean(c) : corotated(c)), right_angle);
        INFO(test::name_of(element) << (stable ? ", stable neo-Hookean" : ", corotated") << ", nu "
                                    << poisson);
        test::must_advance(elbow.world);
        const BodyMeasures m = elbow.world.measures(elbow.body);
        CHECK(m.min_J > 0);
        if (poisson == 0.5) {
          // What bones hold is not free to keep its volume; the flesh around makes up for it.
          CHECK(std::abs(m.volume_change()) < 1e-9);
          CHECK(m.volume_row_residual < 1e-9);
        }
        // The hand is where its bone is.
        const Vec3 hand = elbow.world.positions(elbow.body)[static_cast<std::size_t>(
            test::nearest_node(elbow.world.rest_positions(elbow.body), {0.4, 0, 0}))];
        CHECK(norm(hand - Vec3{0, 0, -0.4}) < 1e-12);
      }
    }
  }
}

TEST_CASE("driven nodes and skins refuse what they cannot mean, by name") {
  DrivenDef d;
  CHECK(refusal(d, driven) == "driven \"driven\": it has no nodes; list those that follow");
  d.nodes = {0, 99};
  CHECK(refusal(d, driven).find("it has no frames") != std::string::npos);
  d.times = {0};
  d.positions = {{{0, 0, 0}}};
  CHECK(refusal(d, driven).find("positions[0] has 1 entries, nodes 2") != std::string::npos);
  d.positions = {{{0, 0, 0}, {0, 0, 0}}};
  CHECK(refusal(d, driven).find("node 99 is none of body \"body\"; its mesh has nodes 0 to 7") !=
        std::string::npos);
  d.positions[0][1].x = std::nan("");
  CHECK(refusal(d, driven).find("positions[0] has a coordinate") != std::string::npos);

  SkinDef s;
  s.where.surfaces = {"x0"};
  CHECK(refusal(s, skin) == "skin \"skin\": it has no bones; give at least one");
  s.bones.resize(1);
  CHECK(refusal(s, skin).find("bones[0]: it has no keyframe") != std::string::npos);
  s.bones[0].track.keys = {{0, {0, 0, 0}, {1, 0, 0, 0}}};
  CHECK(refusal(s, skin).find("bones[0]: give it either weights or a field") != std::string::npos);
  s.bones[0].weights = {1, 2};
  CHECK(refusal(s, skin).find("weights has 2 entries, the mesh of the body 8 nodes") != std::string::npos);
  s.bones[0].weights.assign(8, 0);
  CHECK(refusal(s, skin).find("has no weight of any bone") != std::string::npos);
  s.bones[0].weights[3] = -1;
  CHECK(refusal(s, skin).find("bones[0].weights[3] = -1") != std::string::npos);
  s.bones[0].weights.clear();
  s.bones[0].field = "paint";
  CHECK(refusal(s, skin).find("field \"paint\" is none of the nodes") != std::string::npos);
}
