// What a host asks about bodies and the scene as a whole, against closed forms: volumes of bodies and
// regions, momentum, energies, and how faces and sets of nodes have turned.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "support/worlds.h"

using namespace isochor;
using namespace test;

namespace {

double length(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

// About a unit axis through the origin.
Vec3 turned(const Vec3& v, const Vec3& axis, double angle) {
  return std::cos(angle) * v + std::sin(angle) * cross(axis, v) + (1 - std::cos(angle)) * dot(axis, v) * axis;
}

struct Random {
  std::mt19937 engine;
  explicit Random(unsigned seed) : engine(seed) {}
  double in(double low, double high) { return std::uniform_real_distribution<>(low, high)(engine); }
  Vec3 vector(double size) { return {in(-size, size), in(-size, size), in(-size, size)}; }
  Vec3 direction() {
    for (;;) {
      const Vec3 v = vector(1);
      if (length(v) > 0.1 && length(v) < 1) return (1 / length(v)) * v;
    }
  }
};

bool near(const Vec3& a, const Vec3& b, double tolerance) {
  INFO("(" << a.x << " " << a.y << " " << a.z << ") beside (" << b.x << " " << b.y << " " << b.z << ")");
  CHECK(length(a - b) <= tolerance);
  return length(a - b) <= tolerance;
}

constexpr Vec3 kSize{1, 0.7, 0.4};

Mesh block_for(Element e, double divide = 0.5) {
  return divided(block({0, 0, 0}, kSize, {4, 3, 2}, cells_for(e)), divide);
}

WorldOptions free_motion(SchemePtr scheme) {
  WorldOptions options = dynamic_options();
  options.scheme = std::move(scheme);
  options.consistent_mass = true;
  return options;
}

std::vector<Vec3> moved(const World& world, BodyId body, const std::function<Vec3(const Vec3&)>& map) {
  std::vector<Vec3> x;
  for (const Vec3& X : world.rest_positions(body)) x.push_back(map(X));
  return x;
}

void put(World& world, BodyId body, const std::function<Vec3(const Vec3&)>& map) {
  value(world.compile());
  value(world.set_positions(body, moved(world, body, map)));
}

}  // namespace

TEST_CASE("volumes of bodies and regions follow a stretch that differs between regions") {
  for (const Element e : kAllElements) {
    INFO(name_of(e));
    Random random(7 + static_cast<unsigned>(e));
    World world = make_world(dynamic_options());
    const BodyId body = add_body(world, block_for(e), e, neo_hookean(1e5, 0.3), 1000, "slab");
    const double low = random.in(0.6, 1.4), high = random.in(0.6, 1.4), y = random.in(0.7, 1.3);
    put(world, body, [&](const Vec3& X) {
      const double x = X.x < 0.5 ? low * X.x : 0.5 * low + high * (X.x - 0.5);
      return Vec3{x, y * X.y, X.z};
    });
    const BodyMeasures m = world.measures(body);
    CHECK(m.name == "slab");
    CHECK(m.rest_volume == Approx(kSize.x * kSize.y * kSize.z).epsilon(1e-12));
    CHECK(m.volume_change() == Approx(0.5 * (low + high) * y - 1).epsilon(1e-10).margin(1e-12));
    REQUIRE(m.regions.size() == 2);
    for (const VolumeMeasures& region : m.regions) {
      INFO(region.name);
      const double J = (region.name == "low" ? low : high) * y;
      CHECK(region.rest_volume == Approx(0.5 * m.rest_volume).epsilon(1e-12));
      CHECK(region.volume_change() == Approx(J - 1).epsilon(1e-10).margin(1e-12));
      CHECK(region.min_J == Approx(J).epsilon(1e-10));
      CHECK(region.max_J == Approx(J).epsilon(1e-10));
    }
    CHECK(m.min_J == Approx(std::min(low, high) * y).epsilon(1e-10));
    CHECK(m.max_J == Approx(std::max(low, high) * y).epsilon(1e-10));
  }
}

TEST_CASE("rows that are met do not hide the volume that a compressible body lost") {
  for (const double poisson : {0.2, 0.4, 0.49}) {
    INFO("nu = " << poisson);
    World world = make_world(static_options());
    const BodyId body = add_body(world, block_for(Element::tet4_edge_smoothed), Element::tet4_edge_smoothed,
                                 neo_hookean(1e5, poisson));
    add_volume(world, body);
    // Pressed together between walls along x, free across: J from linear elasticity, 1 - (1 - 2 nu) e.
    hold(world, body, {"x0"}, {{1, 0, 0}});
    hold(world, body, {"y0"}, {{0, 1, 0}});
    hold(world, body, {"z0"}, {{0, 0, 1}});
    const double strain = 1e-3;
    hold(world, body, {"x1"}, {{1, 0, 0}}, {-strain, 0, 0});
    must_advance(world);
    const BodyMeasures m = world.measures(body);
    CHECK(m.volume_row_residual < 1e-9);
    CHECK(m.volume_error == m.volume_row_residual);
    CHECK(m.volume_change() == Approx(-(1 - 2 * poisson) * strain).epsilon(5e-3));
    for (const VolumeMeasures& region : m.regions)
      CHECK(region.volume_change() == Approx(m.volume_change()).epsilon(1e-6));
  }
}

TEST_CASE("momentum of a body that flies and spins is that of the rigid body") {
  for (const Element e : kAllElements) {
    INFO(name_of(e));
    Random random(20 + static_cast<unsigned>(e));
    World world = make_world(free_motion(implicit_midpoint()));
    const double density = random.in(500, 2000);
    const BodyId body = add_body(world, block_for(e), e, neo_hookean(1e6, 0.3), density);
    value(world.compile());
    const Vec3 middle = 0.5 * kSize, v = random.vector(3), w = random.vector(2);
    value(world.set_velocities(body,
                               moved(world, body, [&](const Vec3& X) { return v + cross(w, X - middle); })));
    const double mass = density * kSize.x * kSize.y * kSize.z;
    const auto square = [](double a) { return a * a; };
    const Vec3 spin{mass / 12 * (square(kSize.y) + square(kSize.z)) * w.x,
                    mass / 12 * (square(kSize.x) + square(kSize.z)) * w.y,
                    mass / 12 * (square(kSize.x) + square(kSize.y)) * w.z};
    const Vec3 angular = spin + mass * cross(middle, v);
    const BodyMeasures m = world.measures(body);
    CHECK(m.mass == Approx(mass).epsilon(1e-12));
    near(m.linear_momentum, mass * v, 1e-9 * mass);
    near(m.angular_momentum, angular, 1e-9 * mass);
    CHECK(world.energies().kinetic == Approx(0.5 * mass * dot(v, v) + 0.5 * dot(w, spin)).epsilon(1e-9));
    // Nothing acts on it: what it has stays, and the scene has what its body has.
    for (int k = 0; k < 5; ++k) must_advance(world, 0.01);
    near(world.momentum()[0], mass * v, 1e-7 * mass);
    near(world.momentum()[1], angular, 1e-4 * mass);
    near(world.momentum()[1], world.measures(body).angular_momentum, 1e-12 * mass);
  }
}

TEST_CASE("what a falling body loses in height it has in speed") {
  for (const auto& scheme : {implicit_midpoint(), newmark()}) {
    Random random(31);
    WorldOptions options = free_motion(scheme);
    options.gravity = random.vector(10);
    World world = make_world(options);
    const BodyId body = add_body(world, block_for(Element::tet4), Element::tet4, neo_hookean(1e5, 0.3), 700);
    const double mass = 700 * kSize.x * kSize.y * kSize.z;
    double start = 0;
    for (int k = 1; k <= 8; ++k) {
      must_advance(world, 0.05);
      const double t = 0.05 * k, fallen = 0.5 * mass * dot(options.gravity, options.gravity) * t * t;
      const Energies e = world.energies();
      // Newmark's rule begins with a step of its own, that falls too far.
      if (k == 1) start = e.total();
      CHECK(e.gravity ==
            Approx(-mass * dot(options.gravity, world.measures(body).center_of_mass - 0.5 * kSize)));
      CHECK(e.gravity == Approx(start - fallen).epsilon(1e-8));
      CHECK(e.kinetic == Approx(fallen).epsilon(1e-8));
      CHECK(std::abs(e.total() - start) < 1e-7 * fallen);
      near(world.measures(body).linear_momentum, mass * t * options.gravity, 1e-7 * mass);
    }
  }
}

TEST_CASE("loads that do not follow have the potential of their force times its way") {
  World world = make_world(static_options());
  const Element e = Element::tet4_edge_smoothed;
  const BodyId body = add_body(world, block_for(e), e, neo_hookean(1e5, 0.3));
  hold(world, body, {"x0"}, {{1, 0, 0}});
  hold(world, body, {"y0"}, {{0, 1, 0}});
  hold(world, body, {"z0"}, {{0, 0, 1}});
  TractionDef pull;
  pull.body = body;
  pull.surface = "x1";
  pull.total_force = {60, 0, 0};
  value(world.add(traction(pull)));
  must_advance(world);
  const double way = displacement_at(world, body, kSize).x;
  const Energies energies = world.energies();
  CHECK(energies.loads == Approx(-60 * way).epsilon(1e-9));
  CHECK(energies.gravity == 0);
  CHECK(energies.pressures == 0);
  // Linear elasticity: the load loses twice what the body stores.
  CHECK(energies.elastic == Approx(30 * way).epsilon(1e-2));
  CHECK(energies.potential() == Approx(energies.elastic + energies.loads));
}

namespace {

// A hollow box of 3 cm with a chamber of 1 cm^3 that holds gas, or has the pressure of 1000 Pa.
struct Chamber {
  World world;
  BodyId body;
  double rest = 0;  // volume [m^3]
  Chamber(CavityControl control, SchemePtr scheme) : world(make_world(free_motion(std::move(scheme)))) {
    const Mesh mesh = mapped(hollow_box(false, CellType::tet4), [](const Vec3& p) { return 0.01 * p; });
    body = add_body(world, mesh, Element::tet4_edge_smoothed, neo_hookean(1e5, 0.4));
    add_volume(world, body);
    hold(world, body, {"z0"});
    CavityDef def;
    def.body = body;
    def.surfaces = {"chamber"};
    def.control = control;
    def.amount = Curve::constant(control == CavityControl::pressure ? 1000 : 1);
    value(world.add(cavity(def)));
    value(world.compile());
    rest = gauge(world, "volume");
    // Gas is let go from where the chamber is a little too large.
    if (control == CavityControl::gas)
      put(world, body, [](const Vec3& X) { return Vec3{X.x, X.y, 1.01 * X.z}; });
  }
};

}  // namespace

TEST_CASE("pressures have the potential of the volume they opened") {
  Chamber given(CavityControl::pressure, implicit_midpoint()), gas(CavityControl::gas, implicit_euler());
  for (int k = 0; k < 20; ++k) {
    must_advance(given.world, 1e-4);
    must_advance(gas.world, 1e-4);
    const double V = gauge(gas.world, "volume"), ambient = CavityDef{}.ambient;
    CHECK(given.world.energies().pressures ==
          Approx(-1000 * (gauge(given.world, "volume") - given.rest)).epsilon(1e-9).margin(1e-15));
    // Isothermal: the pressure beyond that outside, integrated over the volume.
    CHECK(gas.world.energies().pressures ==
          Approx(ambient * (V - gas.rest) - ambient * gas.rest * std::log(V / gas.rest))
              .epsilon(1e-4)
              .margin(1e-10));
  }
}

TEST_CASE("a body on a pressure or on gas keeps its total energy while it swings") {
  for (const CavityControl control : {CavityControl::pressure, CavityControl::gas}) {
    INFO((control == CavityControl::gas ? "gas" : "pressure"));
    // Rows of gas must be met at the end of a step, which the midpoint rule does not do.
    Chamber c(control, control == CavityControl::gas ? generalized_alpha(1) : implicit_midpoint());
    double start = std::nan(""), largest = 0, swing = 0, drift = 0;
    for (int k = 0; k < 60; ++k) {
      must_advance(c.world, 5e-5);
      const Energies e = c.world.energies();
      if (std::isnan(start)) start = e.total();
      largest = std::max(largest, e.kinetic);
      swing = std::max(swing, std::abs(e.pressures));
      drift = std::max(drift, std::abs(e.total() - start));
    }
    CHECK(swing > 0.1 * largest);
    CHECK(drift < 0.05 * largest);
  }
}

TEST_CASE("a face and a set of nodes have turned as the body has") {
  for (const Element e : kAllElements) {
    INFO(name_of(e));
    World world = make_world(dynamic_options());
    Mesh mesh = block_for(e);
    // Faces may be listed in any order, seen from either side.
    Random random(50 + static_cast<unsigned>(e));
    const auto per = static_cast<std::size_t>(nodes_per_face(mesh.cell_type));
    for (MeshSurface& s : mesh.surfaces) {
      for (std::size_t f = 0; f < s.faces.size(); f += per) {
        if (random.in(0, 1) < 0.5)
          std::reverse(s.faces.begin() + static_cast<std::ptrdiff_t>(f),
                       s.faces.begin() + static_cast<std::ptrdiff_t>(f + per));
      }
    }
    const BodyId body = add_body(world, mesh, e, neo_hookean(1e5, 0.3));
    Selection face, set, region;
    face.surfaces = {"x1"};
    set.boxes = {{Vec3{-1, -1, kSize.z - 1e-6}, Vec3{2, 2, 2}}};
    region.regions = {"low"};
    for (int round = 0; round < 5; ++round) {
      const Vec3 axis = random.direction(), shift = random.vector(2);
      const double angle = random.in(0.01, std::numbers::pi - 0.01);
      put(world, body, [&](const Vec3& X) { return shift + turned(X, axis, angle); });
      for (const Selection* where : {&face, &set, &region}) {
        const Orientation o = value(world.orientation(*where));
        CHECK(o.angle == Approx(angle).epsilon(1e-9));
        near(o.axis, axis, 1e-8);
        CHECK(o.misfit < 1e-12);
      }
      near(value(world.orientation(face)).normal, turned({1, 0, 0}, axis, angle), 1e-12);
      near(value(world.orientation(set)).normal, turned({0, 0, 1}, axis, angle), 1e-9);
      const Vec3 middle{kSize.x, 0.5 * kSize.y, 0.5 * kSize.z};
      near(value(world.orientation(face)).displacement, shift + turned(middle, axis, angle) - middle, 1e-9);
    }
    // At rest nothing has turned, whichever way a face looks.
    put(world, body, [](const Vec3& X) { return X; });
    for (const auto& [name, normal] :
         {std::pair<const char*, Vec3>{"x0", {-1, 0, 0}}, {"y0", {0, -1, 0}}, {"z1", {0, 0, 1}}}) {
      Selection side;
      side.surfaces = {name};
      const Orientation o = value(world.orientation(side));
      CHECK(o.angle < 1e-7);
      near(o.normal, normal, 1e-12);
    }
  }
}

TEST_CASE("the end of an arm that is bent to an arc has turned by the angle of the arc") {
  for (const double angle : {0.3, 1.2, 2.8}) {
    INFO(angle);
    World world = make_world(dynamic_options());
    const BodyId body = add_body(world, block({0, -0.1, -0.1}, {2, 0.1, 0.1}, {20, 2, 2}), Element::tet4,
                                 neo_hookean(1e5, 0.3));
    const double radius = 2 / angle;
    put(world, body, [&](const Vec3& X) {
      const double a = angle * X.x / 2;
      return Vec3{(radius - X.y) * std::sin(a), radius - (radius - X.y) * std::cos(a), X.z};
    });
    Selection end, closed;
    end.surfaces = {"x1"};
    closed.surfaces = {"x0", "x1", "y0", "y1", "z0", "z1"};
    const Orientation o = value(world.orientation(end));
    CHECK(o.angle == Approx(angle).epsilon(1e-9));
    near(o.axis, {0, 0, 1}, 1e-9);
    near(o.normal, {std::cos(angle), std::sin(angle), 0}, 1e-9);
    CHECK(value(world.orientation(closed)).normal == Vec3{});
    CHECK(value(world.orientation(closed)).misfit > 0.01);
  }
}

TEST_CASE("what has no rotation is refused with its reason") {
  World world = make_world(dynamic_options());
  const BodyId body = add_body(world, block_for(Element::tet4), Element::tet4, neo_hookean(1e5, 0.3));
  value(world.compile());
  Selection line, node, wrong;
  line.boxes = {{Vec3{-1, -1e-6, -1e-6}, Vec3{2, 1e-6, 1e-6}}};
  node.nearest = {Vec3{1, 0, 0}};
  wrong.surfaces = {"lid"};
  for (const Selection* where : {&line, &node}) {
    const auto r = world.orientation(*where);
    REQUIRE_FALSE(r);
    CHECK_THAT(r.error(), ContainsSubstring("one line or in one point at rest"));
  }
  const auto r = world.orientation(wrong);
  REQUIRE_FALSE(r);
  CHECK_THAT(r.error(), ContainsSubstring("\"lid\"") && ContainsSubstring("x0"));
  Selection face;
  face.surfaces = {"x1"};
  put(world, body, [](const Vec3& X) { return Vec3{X.x, 0, 0}; });
  const auto collapsed = world.orientation(face);
  REQUIRE_FALSE(collapsed);
  CHECK_THAT(collapsed.error(), ContainsSubstring("now"));
}

TEST_CASE("stresses are numbers where a law lives through a cell without volume") {
  const ElasticConstants soft{.young = 1e4, .poisson = 0.4};
  const std::vector<MaterialPtr> laws{value(linear(soft)), value(corotated(soft)),
                                      value(stable_neo_hookean(soft))};
  for (std::size_t law = 0; law < laws.size(); ++law) {
    for (const Element element : {Element::tet4, Element::hex8}) {
      CAPTURE(law, static_cast<int>(element));
      World world = make_world(static_options());
      BodyDef body;
      body.mesh =
          block({0, 0, 0}, {1, 1, 1}, {1, 1, 1}, element == Element::hex8 ? CellType::hex8 : CellType::tet4);
      body.element = element;
      body.materials = {{"", laws[law], 1000}};
      const BodyId id = value(world.add_body(body));
      // All of it in one plane.
      for (const char* side : {"z0", "z1"}) {
        DirichletDef d;
        d.name = side;
        d.where.body = id;
        d.where.surfaces = {side};
        if (side[1] == '1') d.displacement = {0, 0, -1};
        value(world.add(dirichlet(d)));
      }
      REQUIRE(world.advance(1).status == StepStatus::converged);
      REQUIRE(world.measures(id).volume == 0);
      const BodyFields f = world.fields(id);
      for (const auto* numbers : {&f.node_pressure, &f.node_stress, &f.cell_pressure, &f.cell_von_mises}) {
        for (const double v : *numbers) CHECK(std::isfinite(v));
      }
    }
  }
}
