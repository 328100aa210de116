// Loads that move next to nothing: energies drown in rounding there, and the step must converge all the same.
#include "support/worlds.h"

using namespace isochor;
using namespace test;

TEST_CASE("a step converges under any load between rounding and softness") {
  for (const bool dynamic : {true, false}) {
    for (const Element element : kElements) {
      for (double traction = 1e-9; traction < 2e3; traction *= 10) {
        INFO(name_of(element) << ", " << traction << " Pa" << (dynamic ? ", dynamic" : ", static"));
        World world = make_world(dynamic ? dynamic_options() : static_options());
        const BodyId body = add_body(world, box({4, 1, 1}, {4, 1, 1}), element, neo_hookean(1e5, 0.5));
        add_volume(world, body);
        hold(world, body, {"x0"});
        TractionDef pull;
        pull.surface = "x1";
        pull.traction = {0, traction, 0};
        value(world.add(isochor::traction(pull)));
        for (int step = 0; step < 2; ++step) {
          const StepReport r = world.step(0.1);
          INFO(r.reason);
          CHECK(r.status == StepStatus::converged);
          CHECK(r.iterations <= 8);
        }
      }
    }
  }
}
