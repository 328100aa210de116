// Work and energy of an inflated chamber, and volume control.
#include <cmath>

#include "support/worlds.h"

using namespace isochor;
using namespace test;

namespace {

struct Chamber {
  World world;
  BodyId body{};
  EffectId air{};

  Chamber(Element element, CavityControl control, const WorldOptions& options = static_options())
      : world(make_world(options)) {
    const CellType type = element == Element::tet10 ? CellType::tet10 : CellType::tet4;
    const Mesh mesh = mapped(hollow_box(false, type), [](const Vec3& p) { return 0.01 * p; });
    body = add_body(world, mesh, element, neo_hookean(1e5, 0.5));
    add_volume(world, body);
    hold(world, body, {"z0"});
    CavityDef def;
    def.surfaces = {"chamber"};
    def.control = control;
    def.amount = Curve::constant(control == CavityControl::pressure ? 0 : 1);
    air = value(world.add(cavity(def)));
  }
};

}  // namespace

TEST_CASE("the work of the air is the elastic energy") {
  for (const Element element : kElements) {
    for (const auto control : {CavityControl::pressure, CavityControl::volume_ratio}) {
      INFO(name_of(element) << ", control " << static_cast<int>(control));
      Chamber c(element, control);
      double work = 0, p = 0, V = gauge(c.world, "volume");
      const double rest = V;
      for (int i = 1; i <= 40; ++i) {
        const double amount = control == CavityControl::pressure ? 1000.0 * i : 1 + 0.05 * i;
        REQUIRE(c.world.set_amount(c.air, amount).ok());
        must_advance(c.world, 0.025);
        const double p_new = gauge(c.world, "pressure"), V_new = gauge(c.world, "volume");
        work += 0.5 * (p + p_new) * (V_new - V);
        p = p_new;
        V = V_new;
      }
      INFO("volume ratio " << V / rest << ", pressure " << p << ", work " << work);
      CHECK(V > 1.2 * rest);
      CHECK(c.world.elastic_energy() == Approx(work).epsilon(0.01));
    }
  }
}

TEST_CASE("volume control holds the volume and pressure control finds it again") {
  for (const Element element : kElements) {
    INFO(name_of(element));
    Chamber c(element, CavityControl::volume_ratio);
    const double rest = gauge(c.world, "volume");
    CHECK(rest == Approx(1e-6).epsilon(1e-12));
    REQUIRE(c.world.set_amount(c.air, 1.8).ok());
    must_advance(c.world);
    CHECK(std::abs(gauge(c.world, "volume") / (1.8 * rest) - 1) < 1e-10);
    const double p = gauge(c.world, "pressure");
    Chamber by_pressure(element, CavityControl::pressure);
    REQUIRE(by_pressure.world.set_amount(by_pressure.air, p).ok());
    must_advance(by_pressure.world);
    CHECK(gauge(by_pressure.world, "volume") == Approx(1.8 * rest).epsilon(1e-6));
    CHECK(by_pressure.world.elastic_energy() == Approx(c.world.elastic_energy()).epsilon(1e-6));
  }
}

TEST_CASE("the settled shape does not depend on the time step, and is that of statics") {
  const double pressure = 15000;
  Chamber resting(Element::tet4_edge_smoothed, CavityControl::pressure);
  REQUIRE(resting.world.set_amount(resting.air, pressure).ok());
  must_advance(resting.world);
  for (const double h : {0.001, 0.005, 0.02}) {
    INFO("h = " << h);
    Chamber c(Element::tet4_edge_smoothed, CavityControl::pressure, dynamic_options());
    REQUIRE(c.world.set_amount(c.air, pressure).ok());
    // Implicit Euler damps by itself; larger steps damp faster. One small increment settles little, so the
    // last ones are long for all.
    for (int i = 0; i < 20; ++i) {
      const StepReport r = c.world.step(h);
      INFO(r.reason);
      REQUIRE(r.status == StepStatus::converged);
      CHECK(gauge(c.world, "pressure") == pressure);
    }
    for (int i = 0; i < 60 && c.world.kinetic_energy() > 1e-16 * c.world.elastic_energy(); ++i) {
      const StepReport r = c.world.step(h);
      INFO(r.reason);
      REQUIRE(r.status == StepStatus::converged);
    }
    double worst = 0;
    for (std::size_t i = 0; i < c.world.positions(c.body).size(); ++i) {
      const Vec3 d = c.world.positions(c.body)[i] - resting.world.positions(resting.body)[i];
      worst = std::max(worst, std::sqrt(dot(d, d)));
    }
    INFO("largest distance from the resting shape " << worst << " of 0.03 m, kinetic energy "
                                                    << c.world.kinetic_energy());
    CHECK(worst < (h < 0.002 ? 1e-4 : 1e-6) * 0.03);
  }
}
