// Rows that are let go: the multiplier that a step asks for tells, not what its bound leaves of it.
#include "isochor/contact.h"
#include "support/worlds.h"

using namespace isochor;

// Large enough for factors in single precision, whose directions are not exact: a point that pulls is put
// back to no force with a residual of either sign. Decided by that, rows are held and let go in turns, and
// the impact takes half as many iterations again.
TEST_CASE("points that pull are let go, however exact directions are") {
  WorldOptions options = test::dynamic_options();
  options.gravity = {0, 0, -9.81};
  World world = test::make_world(options);
  const BodyId body = test::add_body(world, test::scene_mesh("ball"), Element::tet4_edge_smoothed,
                                     test::neo_hookean(1e5, 0.5), 1000);
  test::add_volume(world, body);
  ContactDef floor;
  floor.body = body;
  floor.obstacle.position = {0, 0, -0.15};
  test::value(world.add(contact(floor)));
  Index iterations = 0;
  for (int k = 0; k < 38; ++k) {
    const StepReport r = world.step(0.005);
    INFO("step " << k << ": " << r.iterations << " iterations; " << r.reason);
    REQUIRE(r.status == StepStatus::converged);
    iterations += r.iterations;
  }
  CHECK(iterations <= 66);
}
