// Soft bodies against rigid obstacles in balance, held against closed forms.
#include <cmath>

#include "isochor/contact.h"
#include "support/worlds.h"

namespace {

using namespace isochor;

struct Fixture {
  World world;
  BodyId body{};
};

double gauge_of(const World& world, const std::string& effect, const std::string& quantity) {
  for (const Gauge& g : world.gauges()) {
    if (g.effect == effect && g.quantity == quantity) return g.value;
  }
  FAIL("no gauge " << effect << ", " << quantity);
  return 0;
}

Obstacle floor_at(double z) {
  Obstacle o;
  o.position = {0, 0, z};
  return o;
}

// Coordinate i of n + 1: even steps of size `fine` over [0, inner], then growing steps up to `outer`.
double graded(double s, double inner, double outer, double part) {
  if (s <= part) return inner * s / part;
  const double u = (s - part) / (1 - part), slope = inner / part * (1 - part);
  // a + b u + c u^4 with matching value and slope at u = 0.
  return inner + slope * u + (outer - inner - slope) * u * u * u * u;
}

// A rigid sphere on a half-space, reduced to a narrow wedge about the axis: r outward, z down.
Fixture hertz_wedge(double a, double radius, double depth, double young, double poisson, double angle) {
  const double outer = 60 * a;
  const auto wedge = [&](const Vec3& p) {
    const double r = 0.01 * a + graded(p.x, 1.5 * a, outer, 0.6);
    const double z = -graded(p.z, 1.5 * a, outer, 0.55), phi = (p.y - 0.5) * angle;
    return Vec3{r * std::cos(phi), r * std::sin(phi), z};
  };
  Mesh mesh = test::mapped(test::box({80, 1, 50}, {1, 1, 1}, CellType::hex8), wedge);
  // The map turns cells inside out (z grows downward): swap bottom and top.
  for (std::size_t c = 0; c < mesh.cells.size(); c += 8) {
    for (std::size_t k = 0; k < 4; ++k) std::swap(mesh.cells[c + k], mesh.cells[c + 4 + k]);
  }
  Fixture f{test::make_world(test::static_options()), {}};
  f.body = test::add_body(f.world, mesh, Element::hex8, test::neo_hookean(young, poisson));
  test::hold(f.world, f.body, {"z1"}, {{0, 0, 1}});
  test::hold(f.world, f.body, {"y0"}, {{std::sin(0.5 * angle), std::cos(0.5 * angle), 0}});
  test::hold(f.world, f.body, {"y1"}, {{-std::sin(0.5 * angle), std::cos(0.5 * angle), 0}});
  ContactDef def;
  def.body = f.body;
  def.surfaces = {"z0"};
  def.obstacle.shape = ObstacleShape::sphere;
  def.obstacle.radius = radius;
  def.obstacle.position = {0, 0, radius};
  def.obstacle.motion.keys = {{0, {0, 0, 0}, {1, 0, 0, 0}}, {1, {0, 0, -depth}, {1, 0, 0, 0}}};
  test::value(f.world.add(contact(def)));
  return f;
}

}  // namespace

TEST_CASE("Hertz: force and contact radius over approach, sphere on a half-space") {
  const double pi = std::acos(-1.0), young = 1e5, poisson = 0.3, radius = 1, a = 0.05, angle = 0.1;
  const double depth = a * a / radius, modulus = young / (1 - poisson * poisson);
  Fixture f = hertz_wedge(a, radius, depth, young, poisson, angle);
  for (const double part : {0.5, 0.5}) {
    test::must_advance(f.world, part);
    const double d = depth * f.world.time();
    const double force = 4.0 / 3 * modulus * std::sqrt(radius) * std::pow(d, 1.5);
    const double share = 2 * pi / (2 * std::sin(0.5 * angle));  // the wedge has straight chords
    const double measured = share * gauge_of(f.world, "contact", "force_z");
    INFO("depth " << d << ": force " << measured << " against " << force);
    CHECK(measured == Approx(-force).epsilon(0.03));
    const double contact_radius =
        std::sqrt(2 * gauge_of(f.world, "contact", "contact_area") / std::sin(angle));
    CHECK(contact_radius == Approx(std::sqrt(radius * d)).epsilon(0.03));
    const double peak = 2 * modulus / pi * std::sqrt(d / radius);
    CHECK(gauge_of(f.world, "contact", "largest_pressure") == Approx(peak).epsilon(0.05));
    CHECK(gauge_of(f.world, "contact", "smallest_gap") > -1e-10);
  }
}

namespace {

EffectId add_floor(World& world, BodyId body, double z = 0, std::vector<std::string> surfaces = {}) {
  ContactDef def;
  def.name = "floor";
  def.body = body;
  def.surfaces = std::move(surfaces);
  def.obstacle = floor_at(z);
  return test::value(world.add(contact(def)));
}

constexpr Element kAll[] = {Element::tet4, Element::tet4_edge_smoothed, Element::tet10, Element::hex8};

CellType cells(Element e) {
  return e == Element::hex8 ? CellType::hex8 : (e == Element::tet10 ? CellType::tet10 : CellType::tet4);
}

// The field of contact pressure on the face z = 0 of a block, and nothing elsewhere.
void check_field(const World& world, BodyId body, double pressure, double tolerance) {
  const BodyFields fields = world.fields(body);
  const auto rest = world.rest_positions(body);
  REQUIRE(fields.node_contact_pressure.size() == rest.size());
  REQUIRE(fields.node_friction.size() == 3 * rest.size());
  for (std::size_t i = 0; i < rest.size(); ++i) {
    INFO("node at " << rest[i].x << " " << rest[i].y << " " << rest[i].z);
    if (rest[i].z == 0)
      CHECK(fields.node_contact_pressure[i] == Approx(pressure).epsilon(tolerance));
    else
      CHECK(fields.node_contact_pressure[i] == 0);
    for (std::size_t k = 0; k < 3; ++k) CHECK(fields.node_friction[3 * i + k] == 0);
  }
}

}  // namespace

TEST_CASE("a flat face pressed on a plane has a uniform pressure, whatever the mesh") {
  for (const Element element : {Element::tet4, Element::tet4_edge_smoothed, Element::hex8}) {
    INFO(test::name_of(element));
    World world = test::make_world(test::static_options());
    const auto skew = [](const Vec3& p) {  // uneven faces, flat sides
      return Vec3{p.x + 0.12 * p.x * (1 - p.x), p.y + 0.2 * p.y * (1 - p.y), p.z};
    };
    const BodyId body = test::add_body(
        world, test::mapped(test::block({0, 0, 0}, {1, 1, 0.5}, {5, 4, 3}, cells(element)), skew), element,
        test::neo_hookean(1e4, 0.3));
    test::add_volume(world, body);
    test::hold(world, body, {"x0"}, {{1, 0, 0}});
    test::hold(world, body, {"y0"}, {{0, 1, 0}});
    test::hold(world, body, {"z1"}, {{0, 0, 1}}, {0, 0, -0.05});
    add_floor(world, body, 0, {"z0"});
    test::must_advance(world);
    const double pressure =
        gauge_of(world, "floor", "normal_force") / gauge_of(world, "floor", "contact_area");
    CHECK(gauge_of(world, "floor", "contact_area") == Approx(1).epsilon(1e-12));
    CHECK(gauge_of(world, "floor", "largest_pressure") == Approx(pressure).epsilon(1e-7));
    check_field(world, body, pressure, 1e-7);
    CHECK(std::abs(gauge_of(world, "floor", "smallest_gap")) < 1e-10);
  }
}

TEST_CASE("a block rests at exactly zero gap, on one plane and on two boxes that overlap") {
  for (const Element element : kAll) {
    for (const bool halves : {false, true}) {
      INFO(test::name_of(element) << (halves ? ", two boxes that repeat each other where they overlap" : ""));
      WorldOptions options = test::static_options();
      options.gravity = {0, 0, -9.81};
      World world = test::make_world(options);
      const BodyId body =
          test::add_body(world, test::block({0, 0, 0}, {0.2, 0.1, 0.1}, {4, 2, 2}, cells(element)), element,
                         test::neo_hookean(20e3, 0.49));
      test::add_volume(world, body);
      test::hold(world, body, {"x0"}, {{1, 0, 0}});
      test::hold(world, body, {"y0"}, {{0, 1, 0}});
      double sum = 0;
      std::vector<std::string> names;
      for (int k = 0; k < (halves ? 2 : 1); ++k) {
        ContactDef def;
        def.name = "floor " + std::to_string(k);
        def.body = body;
        def.obstacle = floor_at(0);
        if (halves) {
          def.obstacle.shape = ObstacleShape::box;
          def.obstacle.size = {0.5, 1, 1};
          def.obstacle.position = {k == 0 ? -0.1 : 0.3, 0, -0.5};
        }
        names.push_back(def.name);
        test::value(world.add(contact(def)));
      }
      const StepReport report = test::must_advance(world);
      CHECK(report.substeps == 1);
      for (const auto& name : names) sum += gauge_of(world, name, "force_z");
      CHECK(sum == Approx(0.2 * 0.1 * 0.1 * 1000 * 9.81).epsilon(1e-8));
      for (const Vec3& x : world.positions(body)) CHECK(x.z > -1e-10);
      CHECK(world.constitutive_residual() < 1e-8);
    }
  }
}

TEST_CASE("a compliant layer is pressed in by compliance times pressure, whatever the mesh") {
  double depth[2];
  for (const int n : {2, 5}) {
    World world = test::make_world(test::static_options());
    const BodyId body = test::add_body(world, test::block({0, 0, 0}, {1, 1, 0.5}, {n, n, 2}, CellType::hex8),
                                       Element::hex8, test::neo_hookean(1e4, 0.3));
    test::hold(world, body, {"x0"}, {{1, 0, 0}});
    test::hold(world, body, {"y0"}, {{0, 1, 0}});
    TractionDef load;
    load.body = body;
    load.surface = "z1";
    load.traction = {0, 0, -500};
    test::value(world.add(traction(load)));
    ContactDef def;
    def.body = body;
    def.surfaces = {"z0"};
    def.obstacle = floor_at(0);
    def.compliance = 1e-5;
    test::value(world.add(contact(def)));
    test::must_advance(world);
    depth[n == 5] = -gauge_of(world, "contact", "smallest_gap");
  }
  CHECK(depth[0] == Approx(500 * 1e-5).epsilon(1e-8));
  CHECK(depth[1] == Approx(depth[0]).epsilon(1e-8));
}

TEST_CASE("contact does not pull, and lets a hanging block lift off") {
  World world = test::make_world(test::static_options());
  const BodyId body = test::add_body(world, test::block({0, 0, 0}, {1, 1, 1}, {3, 3, 3}, CellType::tet4),
                                     Element::tet4_edge_smoothed, test::neo_hookean(1e4, 0.5));
  test::add_volume(world, body);
  // Pressed down, then lifted.
  test::hold(world, body, {"z1"}, {}, {0, 0, 1}, Curve{{{0, 0}, {1, -0.1}, {2, 0.05}}});
  add_floor(world, body);
  test::must_advance(world);
  const double pressed = gauge_of(world, "floor", "normal_force");
  CHECK(pressed > 100);
  CHECK(gauge_of(world, "floor", "force_z") == Approx(pressed).epsilon(1e-12));
  test::must_advance(world);
  CHECK(gauge_of(world, "floor", "normal_force") == 0);
  CHECK(gauge_of(world, "floor", "smallest_gap") == Approx(0.05).epsilon(1e-6));
  CHECK(world.elastic_energy() < 1e-9);
}

TEST_CASE("nodes inside an obstacle at the start are reported, or pushed out little by little") {
  for (const auto choice : {InitialOverlap::report, InitialOverlap::resolve}) {
    World world = test::make_world(test::static_options());
    const BodyId body = test::add_body(world, test::block({0, 0, 0}, {1, 1, 1}, {2, 2, 2}, CellType::tet4),
                                       Element::tet4_edge_smoothed, test::neo_hookean(1e4, 0.4));
    test::hold(world, body, {"z1"});
    ContactDef def;
    def.name = "overlapping";
    def.body = body;
    def.obstacle = floor_at(0.1);
    def.initial_overlap = choice;
    test::value(world.add(contact(def)));
    if (choice == InitialOverlap::report) {
      const auto r = world.compile();
      REQUIRE_FALSE(r);
      CHECK(r.error() ==
            "contact \"overlapping\": 9 nodes of body \"body\" are inside the obstacle at the start, node 0 "
            "by 0.1 m; move one of the two, or set initial_overlap to resolve to have them pushed out");
      continue;
    }
    test::must_advance(world, 0.5);
    CHECK(gauge_of(world, "overlapping", "smallest_gap") == Approx(-0.05).epsilon(1e-8));
    test::must_advance(world, 0.5);
    CHECK(std::abs(gauge_of(world, "overlapping", "smallest_gap")) < 1e-9);
  }
}
