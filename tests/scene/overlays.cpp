// What the results page shows beside the bodies.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>

#include "catch.h"
#include "constraints/contact/shape/obstacle_shape.h"
#include "page_surface.h"
#include "scenes/library.h"
#include "scenes/run/page_shape.h"
#include "scenes/run/run_overlays.h"
#include "scenes/run/run_page.h"
#include "small_scene.h"

using namespace isochor;

namespace {

// A block of two regions that stands on a plane, pressed down by its weight, with a cable and a free ball
// above.
SceneDef block() {
  SceneDef s = test::small_scene();
  auto& box = std::get<BoxMeshDef>(s.bodies[0].mesh);
  box.lower = {0, 0, 0};
  box.upper = {1, 1, 1};
  box.divisions = {2, 2, 2};
  s.tractions.clear();
  s.dirichlet.clear();
  s.metrics.clear();
  s.probes.clear();
  s.analysis.options.gravity = {0, 0, -1};
  s.analysis.options.gravity_curve = Curve::constant(1);
  s.analysis.type = AnalysisType::dynamics;
  s.analysis.duration = 0.1;
  s.analysis.steps = 1;
  ContactDef floor;
  floor.name = "floor";
  s.contacts = {floor};
  RigidBodyDef ball;
  ball.name = "ball";
  ball.shape.shape = ObstacleShape::sphere;
  ball.shape.radius = 0.2;
  ball.shape.position = {0.5, 0.5, 3};
  s.rigid_bodies = {ball};
  CableDef cable;
  cable.name = "cable";
  cable.points = {{0.5, 0.5, 0.25}, {0.5, 0.5, 0.75}};
  cable.from = Vec3{0.5, 0.5, -1};
  s.cables = {cable};
  VolumeRows zone;
  zone.def.space = VolumeSpace::zone;
  VolumeZone half;
  half.name = "lower";
  half.boxes = {{Vec3{0, 0, 0}, Vec3{1, 1, 0.5}}};
  zone.def.zones = {half};
  zone.def.carries_bulk = false;
  VolumeRows rows;
  rows.def.name = "rows";
  s.volumes = {rows, zone};
  return s;
}

}  // namespace

TEST_CASE("obstacles, free bodies, cables, contact points and zones reach the page") {
  const SceneDef scene = block();
  auto built = build(scene, {1});
  INFO((built ? std::string() : built.error()));
  REQUIRE(built.ok());
  RunResult result;
  PageScene page;
  std::vector<std::vector<Index>> cells(1);
  PageMeshOptions options;
  options.triangle_cell = &cells[0];
  const Mesh& mesh = built.value().world.mesh(built.value().bodies[0]);
  const auto nodes = add_page_mesh(page, mesh, {"block"}, options);
  REQUIRE(cells[0].size() == page.triangles.size() / 3);
  const RunView view{scene, built.value(), result};
  RunOverlays overlays;
  overlays.start(view, page, cells);
  REQUIRE(page.parts.size() == 3);
  CHECK(page.parts[1].name == "ball");
  CHECK(page.parts[1].obstacle);
  CHECK(page.parts[2].name == "floor");
  CHECK(page.triangle_part.size() == page.triangles.size() / 3);
  REQUIRE(page.lines.size() == 1);
  // One region is no map; two zones are one.
  REQUIRE(page.fields.size() == 1);
  CHECK(page.fields[0].categories == std::vector<std::string>{"no zone", "lower"});

  World& world = built.value().world;
  REQUIRE(world.advance(0.1).status == StepStatus::converged);
  StepRecord record;
  record.time = 0.1;
  record.gauges = world.gauges();
  result.records = {record};
  PageFrame frame;
  for (const Index n : nodes)
    frame.positions.push_back(world.positions(built.value().bodies[0])[static_cast<std::size_t>(n)]);
  overlays.append(view, frame);
  CHECK(frame.positions.size() == page.rest.size());
  // The nine nodes of the lower side, and no other.
  CHECK(frame.contacts.size() == 9);
  for (const Vec3& p : frame.contacts) CHECK(std::abs(p.z) < 1e-5);
  REQUIRE(frame.lines.size() == 1);
  REQUIRE(frame.lines[0].size() == 3);
  CHECK(frame.lines[0][0].z == -1);
  // The ball has fallen by g h^2 in its one step; the floor stays.
  const auto lowest = [&](Index part, const std::vector<Vec3>& points) {
    double z = 1e9;
    for (std::size_t t = 0; t < page.triangle_part.size(); ++t) {
      if (page.triangle_part[t] != part) continue;
      for (std::size_t k = 0; k < 3; ++k)
        z = std::min(z, points[static_cast<std::size_t>(page.triangles[3 * t + k])].z);
    }
    return z;
  };
  CHECK(lowest(1, page.rest) == Approx(2.8));
  CHECK(lowest(1, frame.positions) == Approx(2.79));
  CHECK(lowest(2, frame.positions) == Approx(0).margin(1e-12));
  // The floor carries the block, at the nodes that touch it.
  Vec3 carried{};
  for (const PageForce& f : frame.forces) {
    CHECK(std::abs(f.at.z) < 1e-5);
    carried += f.normal;
  }
  const auto pairs = world.contact_pairs();
  REQUIRE(pairs.size() == 1);
  CHECK(carried.z > 0);
  CHECK(carried.z == Approx(pairs[0].force.z));
  // Zones do not change: the half of the triangles below is in the zone, those above are not.
  REQUIRE(frame.fields.size() == 1);
  for (std::size_t t = 0; t < cells[0].size(); ++t) {
    double z = 0;
    for (std::size_t k = 0; k < 3; ++k)
      z += page.rest[static_cast<std::size_t>(page.triangles[3 * t + k])].z / 3;
    CHECK(frame.fields[0][t] == (z < 0.5 ? 1 : 0));
  }
}

TEST_CASE("painted zones reach the page where they were painted") {
  auto built = build(find_scene("painted_arm")->make({}), {1});
  INFO((built ? std::string() : built.error()));
  REQUIRE(built.ok());
  const SceneDef scene = find_scene("painted_arm")->make({});
  RunResult result;
  PageScene page;
  std::vector<std::vector<Index>> cells(1);
  PageMeshOptions options;
  options.triangle_cell = &cells[0];
  const Mesh& mesh = built.value().world.mesh(built.value().bodies[0]);
  add_page_mesh(page, mesh, {"arm"}, options);
  const RunView view{scene, built.value(), result};
  RunOverlays overlays;
  overlays.start(view, page, cells);
  const auto map = std::find_if(page.fields.begin(), page.fields.end(),
                                [](const PageField& f) { return f.name == "zone"; });
  REQUIRE(map != page.fields.end());
  REQUIRE(map->categories.size() == 3);
  CHECK(map->categories[0] == "no zone");
  PageFrame frame;
  frame.fields.resize(static_cast<std::size_t>(map - page.fields.begin()));
  StepRecord record;
  result.records = {record};
  overlays.append(view, frame);
  const auto& zone = frame.fields.back();
  // The paint is 1 on the upper and the lower half of the skin between the ends and fades within 15 mm.
  int counted = 0;
  for (std::size_t t = 0; t < cells[0].size(); ++t) {
    Vec3 middle{};
    for (std::size_t k = 0; k < 3; ++k)
      middle += (1.0 / 3) * page.rest[static_cast<std::size_t>(page.triangles[3 * t + k])];
    const bool skin = std::hypot(middle.y, middle.z) > 0.025;
    if (!skin) continue;
    const std::string& name = map->categories[static_cast<std::size_t>(zone[t])];
    if (middle.x < 0.02 || middle.x > 0.18) CHECK(name == "no zone");
    if (middle.x < 0.06 || middle.x > 0.14 || std::abs(middle.y) < 0.012) continue;
    CHECK(name == (middle.y > 0 ? "upper" : "lower"));
    ++counted;
  }
  CHECK(counted > 100);
}

TEST_CASE("a free body that turns is drawn turned") {
  SceneDef scene = block();
  scene.rigid_bodies[0].shape.shape = ObstacleShape::box;
  scene.rigid_bodies[0].shape.size = {0.6, 0.2, 0.4};
  auto built = build(scene, {1});
  REQUIRE(built.ok());
  RunResult result;
  PageScene page;
  std::vector<std::vector<Index>> cells(1);
  PageMeshOptions options;
  options.triangle_cell = &cells[0];
  const auto nodes =
      add_page_mesh(page, built.value().world.mesh(built.value().bodies[0]), {"block"}, options);
  const RunView view{scene, built.value(), result};
  RunOverlays overlays;
  overlays.start(view, page, cells);
  StepRecord record;
  const double quarter = std::acos(0.0);
  record.gauges = {{"ball", "rigid_body", "x", "m", 0.5},
                   {"ball", "rigid_body", "y", "m", 0.5},
                   {"ball", "rigid_body", "z", "m", 3},
                   {"ball", "rigid_body", "turn_x", "rad", 0},
                   {"ball", "rigid_body", "turn_y", "rad", quarter},
                   {"ball", "rigid_body", "turn_z", "rad", 0}};
  result.records = {record};
  PageFrame frame;
  frame.positions.resize(nodes.size());
  overlays.append(view, frame);
  Vec3 low{9, 9, 9}, high{-9, -9, -9};
  for (std::size_t k = nodes.size(); k < nodes.size() + 8; ++k) {
    const Vec3 p = frame.positions[k] - Vec3{0.5, 0.5, 3};
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  // x and z have changed places.
  CHECK(high.x - low.x == Approx(0.4));
  CHECK(high.y - low.y == Approx(0.2));
  CHECK(high.z - low.z == Approx(0.6));
}

TEST_CASE("rounded edges are drawn round") {
  for (const auto shape : {ObstacleShape::box, ObstacleShape::cylinder}) {
    CAPTURE(static_cast<int>(shape));
    SceneDef scene = block();
    Obstacle& solid = scene.rigid_bodies[0].shape;
    solid.shape = shape;
    solid.size = {0.6, 0.4, 0.5};
    solid.radius = 0.3;
    solid.length = 0.5;
    solid.rounding = 0.1;
    auto built = build(scene, {1});
    INFO((built ? std::string() : built.error()));
    REQUIRE(built.ok());
    RunResult result;
    PageScene page;
    std::vector<std::vector<Index>> cells(1);
    PageMeshOptions options;
    options.triangle_cell = &cells[0];
    add_page_mesh(page, built.value().world.mesh(built.value().bodies[0]), {"block"}, options);
    RunOverlays overlays;
    overlays.start({scene, built.value(), result}, page, cells);
    // Every point lies on the surface that bodies touch, and the triangles face away from the middle.
    const Obstacle& drawn = built.value().rigid_shapes[0];
    int counted = 0;
    for (std::size_t t = 0; t < page.triangle_part.size(); ++t) {
      if (page.triangle_part[t] != 1) continue;
      std::array<Vec3, 3> p;
      for (std::size_t k = 0; k < 3; ++k) {
        p[k] = page.rest[static_cast<std::size_t>(page.triangles[3 * t + k])];
        CHECK(std::abs(distance_value(drawn, pose_of(drawn, 0).to_own(p[k]))) < 1e-12);
      }
      CHECK(dot(cross(p[1] - p[0], p[2] - p[0]), p[0] - drawn.position) > 0);
      ++counted;
    }
    CHECK(counted > 300);
  }
}

TEST_CASE("a page has the contact pressure where something may touch, and only there") {
  SceneDef scene = block();
  const auto has = [&] {
    const auto fields = page_fields(scene);
    return std::any_of(fields.begin(), fields.end(), [](const PageField& f) {
      return f.name == "contact_pressure" && f.label == "Contact pressure" && f.unit == "Pa" && !f.diverging;
    });
  };
  CHECK(has());
  scene.contacts.clear();
  CHECK(!has());
  scene.surface_contacts.resize(1);
  CHECK(has());
}

TEST_CASE("the contact pressure of a run reaches its page") {
  if (!results_page_available()) return;
  const SceneDef scene = block();
  auto built = build(scene, {1});
  REQUIRE(built.ok());
  RunResult result;
  const RunView view{scene, built.value(), result};
  World& world = built.value().world;
  const auto page = RunPage::start(view);
  REQUIRE(page);
  StepRecord record;
  const auto append = [&] {
    record.gauges = world.gauges();
    result.records = {record};
    page->append(view, {world.fields(built.value().bodies[0])});
  };
  append();
  REQUIRE(world.advance(0.1).status == StepStatus::converged);
  record.time = 0.1;
  append();
  const test::Scratch folder("contact_page");
  const std::string path = (folder / "index.html").string();
  const auto written = page->write(view, path);
  INFO((written ? std::string() : written.error()));
  REQUIRE(written);
  const std::string text = test::slurp(path);
  CHECK(text.find("\"Contact pressure\"") != std::string::npos);
  // The range of every field in the last frame: the fifth is that of the contact pressure, and the floor
  // carries.
  const auto ranges = text.rfind("\"ranges\":");
  REQUIRE(ranges != std::string::npos);
  std::string numbers = text.substr(ranges + 10, text.find("]]", ranges) - ranges - 10);
  std::replace_if(
      numbers.begin(), numbers.end(), [](char c) { return c == '[' || c == ']' || c == ','; }, ' ');
  std::istringstream in(numbers);
  const std::vector<double> bounds{std::istream_iterator<double>(in), {}};
  INFO(numbers);  // seven a field: low, high, not finite, and the ranges without hot spots
  REQUIRE(bounds.size() >= 35);
  double largest = 0;
  for (const double p : world.fields(built.value().bodies[0]).node_contact_pressure)
    largest = std::max(largest, p);
  REQUIRE(largest > 0);
  CHECK(bounds[29] == Approx(largest).epsilon(1e-5));
}

TEST_CASE("fibers are drawn along their direction and go with their cells") {
  for (const char* element : {"tet4", "hex8"}) {
    SceneDef scene =
        test::small_scene({std::string("bodies[0].element=") + element,
                           std::string("bodies[0].mesh.box.cell_type=") + element, "metrics=[]"});
    SceneFibers fibers;
    fibers.direction = {0, 3, 0};
    fibers.k1 = 10;
    scene.bodies[0].materials[0].fibers = {fibers};
    auto built = build(scene, {1});
    INFO((built ? std::string() : built.error()));
    REQUIRE(built.ok());
    RunResult result;
    result.records.resize(1);
    const RunView view{scene, built.value(), result};
    const PageShape shape(view);
    CHECK(shape.has_fibers());
    const PageFrame before = shape.frame(view, {});
    REQUIRE(before.fibers.size() >= 2);
    for (std::size_t i = 0; i < before.fibers.size(); i += 2) {
      const Vec3 d = before.fibers[i + 1] - before.fibers[i];
      CHECK(d.y > 0);
      CHECK(std::abs(d.x) + std::abs(d.z) < 1e-12);
      for (const Vec3& p : {before.fibers[i], before.fibers[i + 1]})
        CHECK((p.x > -0.1 && p.x < 2.1 && p.z > -0.1 && p.z < 1.1));
    }
    for (int i = 0; i < 3; ++i) REQUIRE(built.value().world.advance(1.0 / 3).status == StepStatus::converged);
    const PageFrame after = shape.frame(view, {});
    REQUIRE(after.fibers.size() == before.fibers.size());
    // Pulled along x, the block gets thinner along y.
    double long_before = 0, long_after = 0;
    for (std::size_t i = 0; i < after.fibers.size(); i += 2) {
      const auto length = [i](const PageFrame& f) {
        const Vec3 d = f.fibers[i + 1] - f.fibers[i];
        return std::sqrt(dot(d, d));
      };
      long_before += length(before);
      long_after += length(after);
    }
    CHECK(long_after < 0.99 * long_before);
  }
}
