// Increments of pressure: new loads meet the multipliers of the old state.
#include "support/worlds.h"

using namespace isochor;

// The matrix of the first iteration has too many negative eigenvalues there, the equilibria have not.
TEST_CASE("a pressure that grows is met without a shift") {
  World world = test::make_world(test::static_options());
  BodyDef def;
  def.mesh = test::scene_mesh("finger_small");
  def.materials = {{"body", test::neo_hookean(100e3, 0.5), 1070},
                   {"limiting_layer", test::neo_hookean(3e6, 0.5), 1070}};
  const BodyId body = test::value(world.add_body(std::move(def)));
  test::add_volume(world, body);
  test::hold(world, body, {"clamped"});
  CavityDef air;
  air.body = body;
  air.surfaces = {"chamber"};
  air.amount = Curve::ramp(10e3);
  test::value(world.add(cavity(air)));
  int more = 0;
  for (int k = 0; k < 4; ++k) {
    const StepReport r = world.advance(0.25);
    INFO("step " << k << ": " << r.reason);
    REQUIRE(r.status == StepStatus::converged);
    CHECK(r.shifted == 0);
    CHECK(r.projected == 0);
    CHECK(r.iterations <= 4);
    more += r.factorizations - r.iterations;
  }
  CHECK(more > 0);  // there was something to be met
}
