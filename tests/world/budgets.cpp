// A budget bounds what a step costs and leaves a world that goes on; what is asked to stop stops.
#include <atomic>
#include <cmath>

#include "isochor/contact.h"
#include "support/worlds.h"

namespace {

using namespace isochor;

// The small finger against a wall, inflated at once.
struct Finger {
  World world;
  BodyId body{};
  EffectId chamber{};
  explicit Finger(WorldOptions options, bool wall) : world(test::make_world(options)) {
    BodyDef def;
    def.mesh = test::scene_mesh("finger_small");
    def.materials = {{"body", test::neo_hookean(100e3, 0.5), 1070},
                     {"limiting_layer", test::neo_hookean(3e6, 0.5), 1070}};
    body = test::value(world.add_body(std::move(def)));
    test::add_volume(world, body);
    test::hold(world, body, {"clamped"});
    CavityDef air;
    air.body = body;
    air.surfaces = {"chamber"};
    chamber = test::value(world.add(cavity(air)));
    if (!wall) return;
    ContactDef contact_def;
    contact_def.name = "wall";
    contact_def.body = body;
    contact_def.surfaces = {"tip", "outer"};
    contact_def.obstacle.position = {0, -0.02, 0};
    contact_def.obstacle.axis = {0, 1, 0};
    test::value(world.add(contact(contact_def)));
  }
};

WorldOptions falling() {
  WorldOptions options = test::dynamic_options();
  options.gravity = {0, -9.81, 0};
  return options;
}

}  // namespace

TEST_CASE("steps within a budget of iterations leave a world that whole steps go on from") {
  for (const int budget : {1, 2, 3}) {
    Finger finger(falling(), true);
    StepBudget limit;
    limit.iterations = budget;
    for (int k = 0; k < 30; ++k) {
      test::value(finger.world.set_amount(finger.chamber, 4000));
      const std::uint64_t before = finger.world.state_hash();
      const StepReport r = finger.world.step(1.0 / 60, limit);
      INFO("budget " << budget << ", step " << k << ": " << r.reason);
      CHECK(r.iterations <= budget);
      CHECK(r.factorizations <= 10 * budget + 5);
      // What a few iterations arrive at may be nothing to go on from, and is given back then.
      if (r.status != StepStatus::rejected) {
        CHECK((r.status == StepStatus::converged || r.status == StepStatus::unfinished));
        continue;
      }
      CHECK(finger.world.state_hash() == before);
      CHECK(r.reason.find("the state is as it was: its iterate") != std::string::npos);
    }
    for (int k = 0; k < 2; ++k) test::must_advance(finger.world, 1.0 / 60);
  }
}

TEST_CASE("a state that a budget left unfinished is saved with the way back") {
  StepBudget limit;
  limit.iterations = 1;
  Finger one(falling(), false), other(falling(), false);
  test::value(one.world.set_amount(one.chamber, 500));
  REQUIRE(one.world.step(1.0 / 60, limit).status == StepStatus::unfinished);
  test::value(other.world.load(one.world.save()));
  // More than anything can carry: both give the unfinished state back.
  for (Finger* f : {&one, &other}) {
    test::value(f->world.set_amount(f->chamber, 1e12));
    const StepReport r = f->world.step(1.0 / 60);
    CHECK(r.status == StepStatus::rejected);
    CHECK(r.reason.find("is back") != std::string::npos);
    CHECK(f->world.time() == 0);
  }
  CHECK(one.world.state_hash() == other.world.state_hash());
}

TEST_CASE("a budget bounds every method") {
  for (const Method method : {Method::automatic, Method::condensation, Method::dual_gradients,
                              Method::augmented_gradients, Method::augmented_ascent, Method::dual_ascent}) {
    WorldOptions options = falling();
    options.method = method;
    Finger finger(options, false);
    test::value(finger.world.set_amount(finger.chamber, 2000));
    for (int k = 0; k < 3; ++k) {
      StepBudget limit;
      limit.iterations = 4;
      const StepReport r = finger.world.step(1.0 / 60, limit);
      INFO(static_cast<int>(method) << ", step " << k << ": " << r.reason);
      CHECK(r.iterations <= 4);
      CHECK(r.dual.steps <= 8);
      CHECK((r.status != StepStatus::invalid && r.status != StepStatus::cancelled));
    }
  }
}

TEST_CASE("a request to stop is heard inside of every loop, and the world is as it was") {
  for (const Method method : {Method::automatic, Method::dual_gradients, Method::augmented_gradients,
                              Method::augmented_ascent, Method::dual_ascent}) {
    for (const bool statics_too : {false, true}) {
      WorldOptions options = falling();
      if (statics_too) options.scheme = statics();
      options.method = method;
      Finger finger(options, false);
      test::value(finger.world.set_amount(finger.chamber, 8000));
      test::value(finger.world.compile());
      const std::uint64_t before = finger.world.state_hash();
      // From the n-th time on the answer is yes; soon after, the step must have returned.
      for (const int patience : {0, 3, 40}) {
        std::atomic<int> asked{0};
        finger.world.stop_when([&asked, patience] { return asked++ >= patience; });
        const StepReport r = finger.world.advance(1.0 / 60);
        INFO(static_cast<int>(method)
             << " statics " << statics_too << " patience " << patience << ": " << r.reason);
        CHECK(r.status == StepStatus::cancelled);
        CHECK(asked.load() <= patience + 60);
        CHECK(finger.world.state_hash() == before);
      }
      finger.world.stop_when({});
      if (method == Method::automatic) test::must_advance(finger.world, 1.0 / 60);
    }
  }
}

TEST_CASE("a model that is singular is told at once, with what is wrong and where") {
  // Pressures at nodes of Tet4 without a stabilization.
  WorldOptions options = test::static_options();
  options.gravity = {0, 0, -9.81};
  World world = test::make_world(options);
  const BodyId body = test::add_body(world, test::block({0, 0, 0}, {0.1, 0.1, 0.1}, {3, 3, 3}), Element::tet4,
                                     test::neo_hookean(1e5, 0.5));
  VolumeDef rows;
  rows.name = "pressures";
  rows.body = body;
  rows.stabilization = 0;
  test::value(world.add(volume(rows)));
  test::hold(world, body, {"z0"});
  const StepReport r = world.advance(1);
  CHECK(r.status == StepStatus::rejected);
  CHECK(r.factorizations <= 5);
  INFO(r.reason);
  CHECK(r.reason.find("\"pressures\" depend on each other") != std::string::npos);
  CHECK(r.reason.find("of body \"body\"") != std::string::npos);
}

TEST_CASE("rows that no free coordinate enters are left out, whatever the element, and told") {
  for (const Element element : test::kAllElements) {
    for (const VolumeSpace space : {VolumeSpace::node, VolumeSpace::element}) {
      // Element rows on tets lock at nu = 0.5 and are refused.
      if (space == VolumeSpace::element && element != Element::hex8) continue;
      double tip[2] = {};
      for (const bool hard : {false, true}) {
        WorldOptions options = test::static_options();
        options.gravity = {0, 0, -9.81};
        World world = test::make_world(options);
        const BodyId body = test::add_body(
            world, test::block({0, 0, 0}, {0.1, 0.02, 0.02}, {10, 2, 2}, test::cells_for(element)), element,
            test::neo_hookean(1e5, hard ? 0.5 : 0.4999));
        test::add_volume(world, body, space);
        DirichletDef held;
        held.where.body = body;
        held.where.boxes = {{Vec3{-1, -1, -1}, Vec3{0.05 + 1e-6, 1, 1}}};
        test::value(world.add(dirichlet(held)));
        INFO(test::name_of(element) << ", hard " << hard);
        test::must_advance(world);
        tip[hard ? 1 : 0] = test::displacement_at(world, body, {0.1, 0.01, 0.01}).z;
        bool told = false;
        for (const std::string& w : world.warnings())
          told = told || w.find("no free coordinate") != std::string::npos;
        // A stabilization couples rows, which then have something to do.
        CHECK(told == (hard && (element == Element::tet10 || space == VolumeSpace::element)));
      }
      CHECK(tip[1] == Approx(tip[0]).epsilon(0.01));
    }
  }
}
