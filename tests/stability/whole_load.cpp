// Robots of the library take the pressures of the paper at once.
#include <string>

#include "scenes/library.h"
#include "support/worlds.h"

namespace {

using namespace isochor;

StepReport at_once(const char* name) {
  const LibraryScene* scene = find_scene(name);
  REQUIRE(scene != nullptr);
  auto built = build(scene->make({}), {1});
  INFO((built ? std::string() : built.error()));
  REQUIRE(built.ok());
  World& world = built.value().world;
  const StepReport r = world.step(1);
  UNSCOPED_INFO(name << ": " << r.reason << " " << r.iterations << " iterations, " << r.factorizations
                     << " factorizations");
  if (r.status == StepStatus::converged) {
    for (const BodyId body : built.value().bodies) CHECK(world.measures(body).volume_error < 1e-9);
  }
  return r;
}

}  // namespace

TEST_CASE("the whole load at once within fifteen iterations at nu 0.5") {
  // The paper takes ten to twenty steps of up to ten iterations each.
  for (const char* name : {"cantilever", "tube", "cushion", "bubble", "finger"}) {
    const StepReport r = at_once(name);
    CHECK(r.status == StepStatus::converged);
    CHECK(r.iterations <= 15);
  }
}
