// Cables, windings and layers: what they hold, what they carry, and that they never push.
#include <cmath>

#include "support/worlds.h"

using namespace isochor;
using namespace test;

namespace {

Mesh bar(std::array<int, 3> cells, CellType type = CellType::tet4) {
  return box(cells, {0.2, 0.04, 0.04}, type);
}

struct Bar {
  World world = make_world(static_options());
  BodyId body;
  explicit Bar(std::array<int, 3> cells = {10, 2, 2}, Element element = Element::tet4_edge_smoothed)
      : body(add_body(world, bar(cells, element == Element::tet10 ? CellType::tet10 : CellType::tet4),
                      element, neo_hookean(1e5, 0.49))) {
    add_volume(world, body);
    hold(world, body, {"x0"});
  }
  // Along the lower side, a little inside.
  CableDef below() const {
    CableDef def;
    def.body = BodyId{0};
    for (const double x : {0.003, 0.05, 0.1, 0.15, 0.197}) def.points.push_back({x, 0.02, 0.004});
    return def;
  }
  double read(const std::string& effect, const std::string& quantity) const {
    for (const Gauge& g : world.gauges()) {
      if (g.effect == effect && g.quantity == quantity) return g.value;
    }
    FAIL("no gauge " << effect << " " << quantity);
    return 0;
  }
};

}  // namespace

TEST_CASE("a cable shortened by a tenth has the length asked and reports its tension") {
  for (const Element element : kElements) {
    INFO(name_of(element));
    Bar b({10, 2, 2}, element);
    CableDef def = b.below();
    def.amount = Curve{{{0, 1}, {1, 0.9}}};
    value(b.world.add(cable(def)));
    must_advance(b.world);
    CHECK(b.read("cable", "length") == Approx(0.9 * 0.194).epsilon(1e-9));
    const double tension = b.read("cable", "tension");
    CHECK(tension > 1);
    CHECK(displacement_at(b.world, b.body, {0.2, 0.02, 0.02}).z < -0.02);
    // The other control finds the same shape from the tension.
    Bar pulled({10, 2, 2}, element);
    def.control = CableControl::tension;
    def.amount = Curve::ramp(tension);
    value(pulled.world.add(cable(def)));
    must_advance(pulled.world);
    CHECK(pulled.read("cable", "tension") == tension);
    CHECK(pulled.read("cable", "length") == Approx(0.9 * 0.194).epsilon(1e-6));
  }
}

TEST_CASE("the tension is the work of shortening") {
  Bar b;
  CableDef def = b.below();
  const EffectId id = value(b.world.add(cable(def)));
  double work = 0, tension = 0, length = 0.194;
  for (int i = 1; i <= 20; ++i) {
    REQUIRE(b.world.set_amount(id, 1 - 0.005 * i).ok());
    must_advance(b.world, 0.05);
    const double T = b.read("cable", "tension"), l = b.read("cable", "length");
    work += 0.5 * (tension + T) * (length - l);
    tension = T;
    length = l;
  }
  CHECK(b.world.elastic_energy() == Approx(work).epsilon(5e-3));
}

TEST_CASE("a slack cable carries nothing, and takes up when it is pulled tight again") {
  Bar b;
  CableDef def = b.below();
  const EffectId id = value(b.world.add(cable(def)));
  must_advance(b.world, 0.1);
  REQUIRE(b.world.set_amount(id, 1.05).ok());
  must_advance(b.world, 0.1);
  CHECK(b.read("cable", "tension") == 0);
  CHECK(b.read("cable", "length") == Approx(0.194).epsilon(1e-9));
  double largest = 0;
  for (std::size_t i = 0; i < b.world.positions(b.body).size(); ++i) {
    const Vec3 d = b.world.positions(b.body)[i] - b.world.rest_positions(b.body)[i];
    largest = std::max(largest, std::sqrt(dot(d, d)));
  }
  CHECK(largest < 1e-10);
  REQUIRE(b.world.set_amount(id, 0.97).ok());
  must_advance(b.world, 0.1);
  CHECK(b.read("cable", "tension") > 0.1);
  CHECK(b.read("cable", "length") == Approx(0.97 * 0.194).epsilon(1e-9));
}

TEST_CASE("of two antagonists the one pulls and the other hangs slack") {
  Bar b;
  CableDef low = b.below(), high = b.below();
  low.name = "low";
  low.amount = Curve{{{0, 1}, {1, 0.92}}};
  high.name = "high";
  for (Vec3& p : high.points) p.z = 0.036;
  high.amount = Curve{{{0, 1}, {1, 1.2}}};
  value(b.world.add(cable(low)));
  value(b.world.add(cable(high)));
  must_advance(b.world);
  CHECK(b.read("low", "tension") > 1);
  CHECK(b.read("high", "tension") == 0);
  CHECK(b.read("high", "length") < 1.2 * 0.194);
}

TEST_CASE("an elastic cable follows Hooke, and a fixed end pulls on the body alone") {
  Bar b;
  CableDef def;
  def.body = b.body;
  def.points = {{0.199, 0.02, 0.02}};
  def.to = Vec3{0.3, 0.02, 0.02};
  def.stiffness = 50;
  def.amount = Curve{{{0, 1}, {1, 0.5}}};
  value(b.world.add(cable(def)));
  must_advance(b.world);
  const double T = b.read("cable", "tension"), l = b.read("cable", "length");
  CHECK(T > 0.5);
  CHECK(T == Approx(50 * (l - 0.5 * 0.101)).epsilon(1e-8));
  // The clamp holds against the cable.
  CHECK(b.world.reaction(EffectId{1})[0].x == Approx(-T).epsilon(1e-6));
}

TEST_CASE("cables that make no sense are refused in words") {
  Bar b;
  const auto refusal = [&](const CableDef& def) {
    Bar other;
    const auto r = other.world.add(cable(def));
    if (!r) return r.error();
    const auto compiled = other.world.compile();
    return compiled ? std::string() : compiled.error();
  };
  CableDef def = b.below();
  def.points.resize(1);
  CHECK(refusal(def).find("give at least two, or one and a fixed end") != std::string::npos);
  def = b.below();
  def.points[2] = {3, 3, 3};
  CHECK(refusal(def).find("is not in body") != std::string::npos);
  def = b.below();
  def.points[1] = def.points[0];
  CHECK(refusal(def).find("coincide") != std::string::npos);
  def = b.below();
  def.amount = Curve::ramp(0);
  CHECK(refusal(def).find("must stay positive") != std::string::npos);
  def = b.below();
  def.control = CableControl::tension;
  def.stiffness = 3;
  CHECK(refusal(def).find("leave it out, or control the length") != std::string::npos);
}

TEST_CASE("inextensible threads around a tube turn widening into lengthening") {
  // A square tube under inner pressure, its end free to move along: alone it widens, wound in rings it
  // lengthens more and widens less.
  double widening[2], lengthening[2];
  for (const int wound : {0, 1}) {
    World world = make_world(static_options());
    Mesh mesh =
        without_cells(box({8, 4, 4}, {0.08, 0.04, 0.04}), {-1, 0.01, 0.01}, {1, 0.03, 0.03}, "chamber");
    const BodyId body = add_body(world, mesh, Element::tet4_edge_smoothed, neo_hookean(1e5, 0.45));
    hold(world, body, {"x0"}, {{1, 0, 0}});
    DirichletDef pin;
    pin.name = "pin";
    pin.where.body = body;
    pin.where.nearest = {{0, 0, 0}};
    value(world.add(dirichlet(pin)));
    pin.name = "no turning";
    pin.where.nearest = {{0, 0.04, 0}};
    pin.directions = {{0, 0, 1}};
    value(world.add(dirichlet(pin)));
    CavityDef air;
    air.body = body;
    air.surfaces = {"chamber"};
    air.cap_free_openings = true;
    air.amount = Curve::ramp(8000);
    value(world.add(cavity(air)));
    WindingDef rings;
    rings.body = body;
    for (const double x : {0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07}) {
      rings.paths.push_back({{x, 0, 0},
                             {x, 0.02, 0},
                             {x, 0.04, 0},
                             {x, 0.04, 0.02},
                             {x, 0.04, 0.04},
                             {x, 0.02, 0.04},
                             {x, 0, 0.04},
                             {x, 0, 0.02},
                             {x, 0, 0}});
    }
    if (wound) value(world.add(winding(rings)));
    must_advance(world);
    const Vec3 side =
        displacement_at(world, body, {0.04, 0.04, 0.02}) - displacement_at(world, body, {0.04, 0, 0.02});
    widening[wound] = side.y;
    lengthening[wound] = displacement_at(world, body, {0.08, 0, 0}).x;
    if (!wound) continue;
    for (const Gauge& g : world.gauges()) {
      if (g.quantity == "largest_strain") CHECK(g.value < 1e-9);
      if (g.quantity == "largest_tension") CHECK(g.value > 0.1);
    }
  }
  INFO("widening " << widening[0] << " -> " << widening[1] << ", lengthening " << lengthening[0] << " -> "
                   << lengthening[1]);
  CHECK(widening[0] > 0);
  CHECK(widening[1] < 0.75 * widening[0]);
}

TEST_CASE("a layer that limits strain resists pulling as its stiffness says and lets compression pass") {
  // A very soft block under a layer, stretched along x with free sides: the layer's force is that of a sheet.
  const auto force = [](double stretch, double layer, double slack) {
    World world = make_world(static_options());
    const BodyId body =
        add_body(world, box({8, 8, 1}, {0.1, 0.1, 0.0125}), Element::tet4, neo_hookean(1e3, 0.3));
    const EffectId left = hold(world, body, {"x0"}, {{1, 0, 0}});
    hold(world, body, {"x1"}, {{1, 0, 0}}, {0.1 * stretch, 0, 0});
    hold(world, body, {"y0"}, {{0, 1, 0}});
    hold(world, body, {"y1"}, {{0, 1, 0}});
    hold(world, body, {"z0"}, {{0, 0, 1}});
    if (layer > 0) {
      StrainLimitDef def;
      def.body = body;
      def.surfaces = {"z0"};
      def.stiffness = layer;
      def.slack = slack;
      value(world.add(strain_limit(def)));
    }
    must_advance(world);
    return -world.reaction(left)[0].x;
  };
  const double bare = force(0.01, 0, 0), sheet = force(0.01, 1000, 0) - bare;
  // A sheet held sideways with nu = 1/3: E t / (1 - nu^2) times width times strain, on a mesh of right
  // triangles instead of equilateral ones.
  CHECK(sheet == Approx(1000 / (1 - 1.0 / 9) * 0.1 * 0.01).epsilon(0.25));
  CHECK(std::abs(force(-0.01, 1000, 0) - force(-0.01, 0, 0)) < 1e-3 * sheet);
  CHECK(std::abs(force(0.01, 1000, 0.02) - bare) < 1e-9);
}
