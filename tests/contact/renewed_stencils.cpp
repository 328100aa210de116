// Results are about the state, whatever stencils around other positions have been tried or solved with since.
#include "isochor/contact.h"
#include "support/worlds.h"

namespace {

using namespace isochor;

// A block that slides over another, whose faces do not match its own, by more than a face within the unit of
// load.
World sliding(int most_iterations = 60) {
  WorldOptions options = test::static_options();
  options.max_iterations = most_iterations;
  World world = test::make_world(options);
  const auto material = test::neo_hookean(1e5, 0.3);
  const BodyId low = test::add_body(world, test::block({0, 0, 0}, {1.5, 1, 0.4}, {5, 3, 2}), Element::tet4,
                                    material, 1000, "lower");
  const BodyId high = test::add_body(world, test::block({0.1, 0.1, 0.4}, {0.7, 0.9, 0.8}, {4, 4, 2}),
                                     Element::tet4, material, 1000, "upper");
  test::hold(world, low, {"z0"});
  test::hold(world, high, {"z1"}, {}, {0.6, 0, -0.02});
  SurfaceContactDef touch;
  touch.body = low;
  touch.surfaces = {"z1"};
  touch.against = high;
  touch.against_surfaces = {"z0"};
  touch.friction = 0.2;
  test::value(world.add(surface_contact(touch)));
  return world;
}

// What follows from the state and the stencils around it.
std::vector<double> results(const World& world) {
  std::vector<double> all{world.constitutive_residual(), world.energies().total()};
  for (const Gauge& g : world.gauges()) all.push_back(g.value);
  return all;
}

}  // namespace

TEST_CASE("a loaded state has the results of the moment it was saved, whatever the stencils were") {
  World world = sliding();
  for (int step = 0; step < 3; ++step) test::must_advance(world, 0.1);
  const std::vector<std::byte> saved = world.save();
  const std::vector<double> then = results(world);
  for (int step = 0; step < 5; ++step) test::must_advance(world, 0.1);
  CHECK(results(world) != then);
  test::value(world.load(saved));
  CHECK(results(world) == then);
  World other = sliding();
  test::value(other.load(saved));
  CHECK(results(other) == then);
}

TEST_CASE("a step that is refused leaves the results, stencils included") {
  World world = sliding(6);
  for (int step = 0; step < 3; ++step) test::must_advance(world, 0.05);
  const std::vector<double> before = results(world);
  const std::uint64_t hash = world.state_hash();
  const StepReport r = world.step(0.7);
  INFO(r.reason);
  REQUIRE(r.status == StepStatus::rejected);
  CHECK(world.state_hash() == hash);
  CHECK(results(world) == before);
}
