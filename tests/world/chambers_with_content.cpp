// Chambers that hold gas or liquid: laws of gases, valves, leaks, vacuum, and the weight of a liquid.
#include <cmath>

#include "support/worlds.h"

using namespace isochor;
using namespace test;

namespace {

constexpr double kAmbient = 101325;

// Hollow boxes side by side, each 3 cm wide with a chamber of 1 cm^3, held from below.
struct Chambers {
  World world;
  std::vector<BodyId> bodies;
  std::vector<EffectId> fill;

  Chambers(const std::vector<CavityDef>& defs, const WorldOptions& options = static_options())
      : world(make_world(options)) {
    for (std::size_t i = 0; i < defs.size(); ++i) {
      const Vec3 away{0.05 * static_cast<double>(i), 0, 0};
      const Mesh mesh =
          mapped(hollow_box(false, CellType::tet4), [&](const Vec3& p) { return 0.01 * p + away; });
      bodies.push_back(add_body(world, mesh, Element::tet4_edge_smoothed, neo_hookean(1e5, 0.45), 1000,
                                "box " + std::to_string(i)));
      hold(world, bodies.back(), {"z0"});
    }
    for (std::size_t i = 0; i < defs.size(); ++i) {
      CavityDef def = defs[i];
      def.name = "chamber " + std::to_string(i);
      def.body = bodies[i];
      def.surfaces = {"chamber"};
      fill.push_back(value(world.add(cavity(def))));
    }
  }
  EffectId connect(int from, int to, double conductance, Curve opening = Curve::constant(1)) {
    ValveDef def;
    def.name = "valve " + std::to_string(from) + " " + std::to_string(to);
    def.from = "chamber " + std::to_string(from);
    if (to >= 0) def.to = "chamber " + std::to_string(to);
    def.conductance = conductance;
    def.amount = std::move(opening);
    return value(world.add(valve(def)));
  }
  double read(int chamber, const std::string& quantity) const {
    for (const Gauge& g : world.gauges()) {
      if (g.effect == "chamber " + std::to_string(chamber) && g.quantity == quantity) return g.value;
    }
    FAIL("no such gauge");
    return 0;
  }
};

CavityDef gas(double polytropic, Curve supplied) {
  CavityDef def;
  def.control = CavityControl::gas;
  def.polytropic = polytropic;
  def.amount = std::move(supplied);
  return def;
}

CavityDef liquid(Curve supplied) {
  CavityDef def;
  def.control = CavityControl::liquid;
  def.amount = std::move(supplied);
  return def;
}

}  // namespace

TEST_CASE("a closed gas chamber obeys its law, from vacuum to overpressure") {
  for (const double n : {1.0, 1.4}) {
    for (const double end : {0.5, 1.0, 2.5}) {
      INFO("polytropic exponent " << n << ", " << end << " times the gas");
      Chambers c({gas(n, Curve::constant(1))});
      REQUIRE(c.world.set_amount(c.fill[0], end).ok());
      for (const double part : {0.5, 0.5}) {
        must_advance(c.world, part);
        const double p = kAmbient + c.read(0, "pressure"), V = c.read(0, "volume"), m = c.read(0, "content");
        CHECK(p * std::pow(V / m, n) == Approx(kAmbient).epsilon(1e-10));
      }
      CHECK(c.read(0, "content") == Approx(end * 1e-6).epsilon(1e-12));
      if (end < 1) CHECK(c.read(0, "pressure") < -5000);
      if (end == 1) CHECK(std::abs(c.read(0, "pressure")) < 1e-3);
      if (end > 1) CHECK(c.read(0, "pressure") > 5000);
    }
  }
}

TEST_CASE("gas that flows in over time obeys its law at every step, whatever the step") {
  std::vector<double> last;
  for (const double h : {0.01, 0.002}) {
    WorldOptions options = dynamic_options();
    Chambers c({gas(1.4, Curve{{{0, 1}, {0.02, 2}}})}, options);
    for (double t = 0; t < 0.0399; t += h) {
      must_advance(c.world, h);
      const double p = kAmbient + c.read(0, "pressure"), V = c.read(0, "volume");
      const double m = 1e-6 * (1 + std::min(c.world.time() / 0.02, 1.0));
      CHECK(c.read(0, "content") == Approx(m).epsilon(1e-12));
      CHECK(p * std::pow(V / m, 1.4) == Approx(kAmbient).epsilon(1e-10));
    }
    last.push_back(c.read(0, "pressure"));
  }
  // A pressure in pascal, not an impulse: the same whatever the step, but for how the swing has died down.
  CHECK(last[0] == Approx(last[1]).epsilon(0.05));
}

TEST_CASE("two connected gas chambers equalise, and keep what they held when the valve is shut") {
  for (const double n : {1.0, 1.3}) {
    INFO("polytropic exponent " << n);
    Chambers c({gas(n, Curve{{{0, 1}, {1, 2}}}), gas(n, Curve::constant(1))});
    const EffectId tap = c.connect(0, 1, 1e-9, Curve{{{0, 0}, {1, 0}, {1.5, 1}}});
    must_advance(c.world, 1);
    const double before = c.read(0, "pressure");
    CHECK(before > 5000);
    CHECK(std::abs(c.read(1, "pressure")) < 1e-3);
    CHECK(c.read(1, "content") == Approx(1e-6).epsilon(1e-12));
    for (int i = 0; i < 10; ++i) must_advance(c.world, 1);
    const double p = c.read(0, "pressure"), q = c.read(1, "pressure");
    CHECK(p == Approx(q).epsilon(1e-8));
    CHECK(p > 0.2 * before);
    CHECK(p < 0.8 * before);
    CHECK(c.read(0, "content") + c.read(1, "content") == Approx(3e-6).epsilon(1e-12));
    for (int i : {0, 1}) {
      const double law =
          (kAmbient + c.read(i, "pressure")) * std::pow(c.read(i, "volume") / c.read(i, "content"), n);
      CHECK(law == Approx(kAmbient).epsilon(1e-10));
    }
    // Shut again: what comes into the first stays there.
    REQUIRE(c.world.set_amount(tap, 0).ok());
    must_advance(c.world, 0.1);
    const double held = c.read(1, "content");
    REQUIRE(c.world.set_amount(c.fill[0], 2.5).ok());
    must_advance(c.world, 1);
    CHECK(c.read(1, "content") == Approx(held).epsilon(1e-9));
    CHECK(c.read(0, "pressure") > 1.2 * p);
  }
}

TEST_CASE("liquid flows between chambers until their pressures agree, and none is lost") {
  Chambers c({liquid(Curve{{{0, 1}, {1, 1.6}}}), liquid(Curve::constant(1))});
  c.connect(0, 1, 1e-9);
  for (int i = 0; i < 10; ++i) {
    must_advance(c.world, 1);
    CHECK(c.read(0, "volume") + c.read(1, "volume") == Approx(2.6e-6).epsilon(1e-10));
  }
  CHECK(c.read(0, "pressure") == Approx(c.read(1, "pressure")).epsilon(1e-8));
  CHECK(c.read(0, "volume") == Approx(1.3e-6).epsilon(1e-6));
}

TEST_CASE("a leak lets out what the difference of pressures drives, to first order in the step") {
  // Reference by integrating the reported flow with small steps.
  const auto lost = [](int steps) {
    Chambers c({gas(1, Curve{{{0, 1}, {1, 2.5}}})});
    c.connect(0, -1, 1e-11, Curve{{{0, 0}, {1, 0}, {1.0001, 1}}});
    must_advance(c.world, 1);
    must_advance(c.world, 1e-3);
    const double before = c.read(0, "content");
    double flown = 0;
    for (int i = 0; i < steps; ++i) {
      must_advance(c.world, 4.0 / steps);
      flown += 4.0 / steps * 1e-11 * c.read(0, "pressure");
    }
    const double gone = before - c.read(0, "content");
    return std::array{gone, flown};
  };
  const auto coarse = lost(8), fine = lost(32);
  CHECK(fine[0] > 1e-7);
  const double coarse_error = std::abs(coarse[0] / coarse[1] - 1),
               fine_error = std::abs(fine[0] / fine[1] - 1);
  CHECK(coarse_error < 0.02);
  CHECK(fine_error < 0.35 * coarse_error);
}

TEST_CASE("the weight of a liquid presses like depth times density times gravity") {
  // A cup that is rigid: its walls are held, and the reaction carries the liquid.
  for (const Vec3& g : {Vec3{0, 0, -9.81}, Vec3{3, -5, -8}}) {
    CavityDef def = liquid(Curve::constant(1));
    def.density = 1200;
    def.gravity = g;
    Chambers c({def});
    must_advance(c.world);
    EffectId floor{0};  // the first effect is the hold
    const Vec3 force = c.world.reaction(floor)[0];
    // The body itself is weightless here: the support carries the liquid alone.
    const Vec3 weight = 1200 * 1e-6 * g;
    for (int k = 0; k < 3; ++k) CHECK(force[k] == Approx(-weight[k]).epsilon(1e-6).margin(1e-9));
    CHECK(c.read(0, "volume") == Approx(1e-6).epsilon(1e-10));
  }
}

TEST_CASE("moving the datum moves the reported pressure by depth times density times gravity") {
  double pressure[2];
  for (const int high : {0, 1}) {
    CavityDef def = liquid(Curve::constant(1.1));
    def.density = 1000;
    def.gravity = {0, 0, -10};
    def.datum = Vec3{0, 0, high ? 0.1 : 0.0};
    Chambers c({def});
    must_advance(c.world);
    pressure[high] = c.read(0, "pressure");
  }
  CHECK(pressure[0] - pressure[1] == Approx(1000.0).epsilon(1e-8));
}

TEST_CASE("state of chambers is saved and restored with the world") {
  const auto make = [] {
    Chambers c({gas(1.4, Curve{{{0, 1}, {2, 2}}}), gas(1.4, Curve::constant(1))});
    c.connect(0, 1, 1e-12);
    return c;
  };
  Chambers a = make(), b = make();
  must_advance(a.world, 0.5);
  value(b.world.load(a.world.save()));
  must_advance(a.world, 0.5);
  must_advance(b.world, 0.5);
  CHECK(a.world.state_hash() == b.world.state_hash());
  CHECK(a.read(1, "content") > 1.0000001e-6);
}

TEST_CASE("contents that make no sense are refused in words") {
  World world = make_world(static_options());
  const auto refusal = [&](const EffectPtr& effect) {
    const auto r = world.add(effect);
    return r.ok() ? std::string() : r.error();
  };
  CavityDef def = gas(0.5, Curve::constant(1));
  def.surfaces = {"chamber"};
  CHECK(refusal(cavity(def)).find("polytropic = 0.5") != std::string::npos);
  def = gas(1, Curve::constant(0));
  def.surfaces = {"chamber"};
  CHECK(refusal(cavity(def)).find("some gas must stay") != std::string::npos);
  def = gas(1, Curve::constant(1));
  def.surfaces = {"chamber"};
  def.ambient = -3;
  CHECK(refusal(cavity(def)).find("ambient = -3") != std::string::npos);
  ValveDef v;
  v.from = "a";
  CHECK(refusal(valve(v)).find("conductance = 0") != std::string::npos);
  v.conductance = 1e-9;
  v.amount = Curve::constant(-1);
  CHECK(refusal(valve(v)).find("opening -1") != std::string::npos);
  Chambers wrong({gas(1, Curve::constant(1)), liquid(Curve::constant(1))});
  wrong.connect(0, 1, 1e-9);
  const auto compiled = wrong.world.compile();
  REQUIRE_FALSE(compiled.ok());
  CHECK(compiled.error().find("hold different contents") != std::string::npos);
  Chambers missing({gas(1, Curve::constant(1))});
  missing.connect(0, 7, 1e-9);
  const auto unknown = missing.world.compile();
  REQUIRE_FALSE(unknown.ok());
  CHECK(unknown.error().find("there is no chamber \"chamber 7\"") != std::string::npos);
}
