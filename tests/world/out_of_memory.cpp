// Memory that runs out at any allocation of any call: the call says so, the world is as it was, and does the
// same once more where there is memory again.
#include <algorithm>
#include <functional>
#include <new>
#include <optional>

#include "isochor/gradients.h"
#include "support/allocations.h"
#include "support/worlds.h"

namespace {

using namespace isochor;
using test::FailingAllocation;

struct Live {
  World world;
  BodyId body{};
  EffectId load{};
};

Mesh bar(const Vec3& lower, const Vec3& upper) {
  return test::block(lower, upper, {3, 2, 2});
}

Live pulled(WorldOptions options) {
  Live live{test::make_world(options), {}, {}};
  live.body =
      test::add_body(live.world, bar({0, 0, 0}, {2, 1, 1}), Element::tet4, test::neo_hookean(1e5, 0.5));
  test::add_volume(live.world, live.body);
  test::hold(live.world, live.body, {"x0"});
  TractionDef pull;
  pull.surface = "x1";
  pull.traction = {0, 3000, 500};
  live.load = test::value(live.world.add(traction(pull)));
  return live;
}

Live pulled_statics() {
  return pulled(test::static_options());
}

Live pulled_by_gradients() {
  WorldOptions options = test::static_options();
  options.method = Method::dual_gradients;
  return pulled(options);
}

Live pulled_on_two_threads() {
  WorldOptions options = test::dynamic_options();
  options.threads = 2;
  return pulled(options);
}

// Stencils that change with what is close, friction and impacts, which keep numbers from step to step.
Live dropped() {
  WorldOptions options = test::dynamic_options();
  options.gravity = {0, 0, -9.81};
  Live live{test::make_world(options), {}, {}};
  live.body =
      test::add_body(live.world, bar({0, 0, 0.001}, {2, 1, 1}), Element::tet4, test::neo_hookean(1e5, 0.4));
  const BodyId upper = test::add_body(live.world, bar({0.3, 0, 1.002}, {1.9, 1, 2}), Element::tet4,
                                      test::neo_hookean(1e5, 0.4), 1000, "upper");
  ContactDef floor;
  floor.body = live.body;
  floor.friction = 0.3;
  test::value(live.world.add(contact(floor)));
  SurfaceContactDef between;
  between.body = upper;
  between.against = live.body;
  between.friction = 0.2;
  test::value(live.world.add(surface_contact(between)));
  TractionDef push;
  push.body = upper;
  push.surface = "z1";
  push.traction = {200, 0, -500};
  live.load = test::value(live.world.add(traction(push)));
  return live;
}

struct Start {
  std::string name;
  std::function<Live()> make;
};
const std::vector<Start>& starts() {
  static const std::vector<Start> all = {{"statics", pulled_statics},
                                         {"dual gradients", pulled_by_gradients},
                                         {"two threads", pulled_on_two_threads},
                                         {"contact", dropped}};
  return all;
}

Live compiled(const Start& start) {
  Live live = start.make();
  test::value(live.world.compile());
  return live;
}

Live on_its_way(const Start& start) {
  Live live = start.make();
  for (int k = 0; k < 2; ++k) test::must_advance(live.world, 0.02);
  return live;
}

// What a call says; empty: it did what it was asked for.
using Call = std::function<std::string(Live&)>;

std::string why(const StepReport& report) {
  return report.status == StepStatus::converged ? std::string() : report.reason;
}
template <class T>
std::string why(const Result<T>& result) {
  return result ? std::string() : result.error();
}

std::string outcome(const Call& call, Live& live) {
  try {
    return call(live);
  } catch (const std::bad_alloc&) {
    return "memory: thrown";  // as short as a string holds without memory
  }
}

// The allocations that are let fail: the first ones each, then fewer and fewer.
long next_after(long n) {
  return n + std::max(1L, n / 3);
}

void survives(const Start& start, const Call& call, Live (*begin)(const Start&) = on_its_way) {
  Live other = begin(start);
  REQUIRE(call(other).empty());
  const std::uint64_t after = other.world.state_hash();
  for (const bool ever_after : {false, true}) {
    Live live = begin(start);
    const std::uint64_t before = live.world.state_hash();
    int told = 0;
    for (long n = 1;; n = next_after(n)) {
      INFO(start.name << ", allocation " << n << (ever_after ? " and all others" : ""));
      REQUIRE(n < 10000000);
      std::string said;
      bool failed = false;
      {
        const FailingAllocation failing(n, ever_after);
        said = outcome(call, live);
        failed = failing.failed();
      }
      if (!failed) {
        CHECK(said.empty());
        CHECK(live.world.state_hash() == after);
        break;
      }
      if (said.empty()) {  // another way was found, or only words were missing
        live = begin(start);
        continue;
      }
      ++told;
      CHECK_THAT(said, ContainsSubstring("memory"));
      REQUIRE(live.world.state_hash() == before);
    }
    CHECK(told > 0);
  }
}

}  // namespace

TEST_CASE("steps for which memory runs out leave the state, and the next one is as it would have been") {
  // The first step, as a later one takes no memory.
  for (const Start& start : starts()) {
    survives(
        start, [](Live& live) { return why(live.world.step(0.02)); }, compiled);
    survives(
        start,
        [](Live& live) {
          return why(live.world.step(0.02, {50, 0}));
        },
        compiled);
  }
  // Stencils are made anew with every step.
  survives(starts().back(), [](Live& live) { return why(live.world.step(0.02)); });
}

// Increments that were arrived at stay; the rest of the way is as it would have been.
TEST_CASE("an advance for which memory runs out is at an increment that it arrived at") {
  for (const Start& start : starts()) {
    for (long n = 1;; n = next_after(n)) {
      Live live = compiled(start);
      const double t0 = live.world.time();
      StepReport report;
      bool failed = false;
      {
        const FailingAllocation failing(n, true);
        report = live.world.advance(0.02);
        failed = failing.failed();
      }
      INFO(start.name << ", allocation " << n << ": " << report.reason);
      CHECK(report.time == live.world.time());
      if (!failed) {
        CHECK(report.status == StepStatus::converged);
        break;
      }
      CHECK_THAT(report.reason, ContainsSubstring("memory"));
      if (live.world.time() < t0 + 0.02) test::must_advance(live.world, t0 + 0.02 - live.world.time());
    }
  }
}

TEST_CASE("changes for which memory runs out are taken back") {
  for (const Start& start : starts()) {
    // Constants, and another structure.
    survives(start, [](Live& live) {
      if (auto r = live.world.set_density(live.body, "", 2000); !r) return r.error();
      return why(live.world.compile());
    });
    survives(start, [](Live& live) {
      DirichletDef def;
      def.name = "another";
      def.where.body = live.body;
      def.where.surfaces = {"x1"};
      def.directions = {{1, 0, 0}};
      if (auto r = live.world.add(dirichlet(def)); !r) return r.error();
      return why(live.world.compile());
    });
    survives(start, [](Live& live) {
      const std::size_t effects = live.world.effects().size();
      if (auto r = live.world.remove(live.load); !r) return r.error();
      auto r = live.world.compile();
      if (!r && live.world.effects().size() != effects) return std::string("the effect is gone");
      return why(r);
    });
  }
}

TEST_CASE("saving, loading, cloning and starting anew survive that memory runs out") {
  for (const Start& start : starts()) {
    survives(start, [](Live& live) { return live.world.save().empty() ? std::string("no bytes") : ""; });
    const auto saved = start.make().world.save();
    survives(start, [&](Live& live) { return why(live.world.load(saved)); });
    survives(start, [](Live& live) { return why(live.world.clone()); });
    survives(start, [](Live& live) {
      const std::vector<Vec3> forces(live.world.positions(live.body).size(), Vec3{0, 0, 1});
      return why(live.world.set_forces(live.body, forces));
    });
  }
  // To begin anew is done once it is begun; then only stencils are missing, which the next call makes.
  for (const Start& start : starts()) {
    Live fresh = start.make();
    test::value(fresh.world.compile());
    test::must_advance(fresh.world, 0.02);
    for (const bool ever_after : {false, true}) {
      for (long n = 1;; n = next_after(n)) {
        INFO(start.name << ", allocation " << n);
        Live live = on_its_way(start);
        bool failed = false;
        {
          const FailingAllocation failing(n, ever_after);
          (void)live.world.reset();
          failed = failing.failed();
        }
        test::value(live.world.reset());
        test::must_advance(live.world, 0.02);
        CHECK(live.world.state_hash() == fresh.world.state_hash());
        if (!failed) break;
      }
    }
  }
}

TEST_CASE("derivatives survive that memory runs out") {
  survives(starts().front(), [](Live& live) {
    ResponseInput input;
    input.effect = live.load;
    return why(live.world.derivatives(std::span(&input, 1)));
  });
}

TEST_CASE("gradients and the origins of errors survive that memory runs out") {
  for (const auto mode : {GradientQuery::Mode::adjoint, GradientQuery::Mode::tangent}) {
    survives(starts().front(), [=](Live& live) {
      GradientQuery query;
      query.outputs = {Output::node(live.body, 3, {0, 0, 1})};
      query.parameters = {Parameter::amount_of(live.load), Parameter::density(live.body)};
      query.mode = mode;
      return why(live.world.gradients(query));
    });
  }
  survives(starts().front(), [](Live& live) {
    return why(live.world.error_origins(std::vector<Output>{Output::elastic_energy()}));
  });
}

// Behind the first steps the state is another, which must not be left to a host that was told there is none.
TEST_CASE("a way through time for which memory runs out is not gone") {
  for (const std::size_t start : {0, 2}) {
    for (const auto mode : {GradientQuery::Mode::adjoint, GradientQuery::Mode::tangent}) {
      survives(starts().at(start), [=](Live& live) {
        TrajectoryQuery query;
        query.steps = {0.02, 0.03, 0.02};
        query.outputs = {{{{3, Output::node(live.body, 3, {0, 0, 1})}}}};
        query.parameters = {Parameter::amount_of(live.load), Parameter::density(live.body)};
        query.mode = mode;
        query.kept_states = 2;
        return why(live.world.trajectory_gradients(query));
      });
    }
  }
}

TEST_CASE("a world can be built although memory runs out on the way") {
  std::optional<FailingAllocation> failing;
  bool failed = false;
  // Once more with memory, where there was none.
  const auto insist = [&](auto&& call) {
    auto first = call();
    if (first) return first;
    CHECK_THAT(first.error(), ContainsSubstring("memory"));
    failed = failing && failing->failed();
    failing.reset();
    auto second = call();
    if (!second) FAIL(second.error());
    return second;
  };
  const auto build = [&] {
    World world = std::move(insist([] { return World::create(test::static_options()); })).value();
    BodyDef def;
    def.mesh = bar({0, 0, 0}, {2, 1, 1});
    def.materials = {{"", test::neo_hookean(1e5, 0.5), 1000}};
    const BodyId body = insist([&] { return world.add_body(def); }).value();
    VolumeDef rows;
    rows.body = body;
    DirichletDef hold;
    hold.where.surfaces = {"x0"};
    hold.displacement = {0.1, 0, 0};
    const EffectPtr volume_rows = volume(rows), support = dirichlet(hold);
    (void)insist([&] { return world.add(volume_rows); });
    (void)insist([&] { return world.add(support); });
    (void)insist([&] { return world.compile(); });
    if (failing) failed = failing->failed();
    failing.reset();
    CHECK(world.bodies().size() == 1);
    CHECK(world.effects().size() == 2);
    CHECK(world.warnings().empty());
    test::must_advance(world, 1);
    return world.state_hash();
  };
  const std::uint64_t expected = build();
  for (const bool ever_after : {false, true}) {
    for (long n = 1;; n = next_after(n)) {
      INFO("allocation " << n);
      failed = false;
      failing.emplace(n, ever_after);
      std::uint64_t hash = 0;
      try {
        hash = build();
      } catch (const std::bad_alloc&) {  // of what this test makes itself
        failing.reset();
        continue;
      }
      CHECK(hash == expected);
      if (!failed) break;
    }
  }
}
