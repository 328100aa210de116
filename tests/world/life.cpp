// The life of a world: checkpoints, amounts set by a host, cancellation, several worlds at once.
#include <cmath>
#include <thread>

#include "support/worlds.h"

using namespace isochor;
using namespace test;

namespace {

// A hollow block on a support, with a chamber and gravity.
struct Block {
  World world;
  BodyId body{};
  EffectId chamber{};

  explicit Block(const WorldOptions& options, Element element = Element::tet4_edge_smoothed,
                 Curve pressure = Curve::constant(0), CellType type = CellType::tet4)
      : world(make_world(with_gravity(options))) {
    const Mesh mesh = mapped(hollow_box(false, type), [](const Vec3& p) { return 0.02 * p; });
    body = add_body(world, mesh, element, neo_hookean(1e5, 0.5));
    add_volume(world, body);
    hold(world, body, {"z0"});
    CavityDef def;
    def.surfaces = {"chamber"};
    def.amount = std::move(pressure);
    chamber = value(world.add(cavity(def)));
  }
  static WorldOptions with_gravity(WorldOptions o) {
    o.gravity = {0, 0, -9.8};
    return o;
  }
};

}  // namespace

TEST_CASE("a checkpoint continues with the same bits, in the same world and in another") {
  for (const bool dynamic : {true, false}) {
    for (const Element element : kElements) {
      INFO(name_of(element) << (dynamic ? ", dynamic" : ", static"));
      const WorldOptions options = dynamic ? dynamic_options() : static_options();
      const double h = dynamic ? 0.01 : 0.1;
      Block a(options, element, Curve::ramp(4000, 10 * h));
      for (int i = 0; i < 3; ++i) REQUIRE(a.world.step(h).status == StepStatus::converged);
      REQUIRE(a.world.set_amount(a.chamber, 3000).ok());
      const auto saved = a.world.save();
      const std::uint64_t at_save = a.world.state_hash();
      std::vector<std::uint64_t> first;
      for (int i = 0; i < 3; ++i) {
        REQUIRE(a.world.step(h).status == StepStatus::converged);
        first.push_back(a.world.state_hash());
      }
      const double volume = gauge(a.world, "volume");
      REQUIRE(a.world.load(saved).ok());
      CHECK(a.world.state_hash() == at_save);
      Block b(options, element, Curve::ramp(4000, 10 * h));
      REQUIRE(b.world.load(saved).ok());
      CHECK(b.world.time() == a.world.time());
      for (World* world : {&a.world, &b.world}) {
        for (const std::uint64_t hash : first) {
          REQUIRE(world->step(h).status == StepStatus::converged);
          CHECK(world->state_hash() == hash);
        }
        CHECK(gauge(*world, "volume") == volume);
      }
    }
  }
}

TEST_CASE("a damaged or foreign checkpoint is refused and changes nothing") {
  Block a(static_options());
  REQUIRE(a.world.step(0.1).status == StepStatus::converged);
  const auto saved = a.world.save();
  const std::uint64_t hash = a.world.state_hash();
  auto shorter = saved;
  shorter.resize(saved.size() - 8);
  CHECK_FALSE(a.world.load(shorter).ok());
  auto longer = saved;
  longer.resize(saved.size() + 8);
  CHECK_FALSE(a.world.load(longer).ok());
  CHECK_FALSE(a.world.load({}).ok());
  auto other = saved;
  other[0] = std::byte{0};
  CHECK_FALSE(a.world.load(other).ok());
  for (std::size_t i = 8; i < 64; ++i) {
    auto bent = saved;
    bent[i] ^= std::byte{0x40};
    (void)a.world.load(bent);
    REQUIRE(a.world.load(saved).ok());
  }
  Block b(static_options(), Element::tet10);
  CHECK_FALSE(b.world.load(saved).ok());
  CHECK(a.world.state_hash() == hash);
}

TEST_CASE("an amount that a host sets ramps in over the next increment of statics") {
  Block a(static_options());
  REQUIRE(a.world.set_amount(a.chamber, 2000).ok());
  CHECK(gauge(a.world, "pressure") == 0);
  must_advance(a.world, 1);
  CHECK(gauge(a.world, "pressure") == Approx(2000).epsilon(1e-14));
  // It holds from then on.
  must_advance(a.world, 1);
  CHECK(gauge(a.world, "pressure") == Approx(2000).epsilon(1e-14));
  // One increment of half the length takes the whole change too.
  REQUIRE(a.world.set_amount(a.chamber, 1000).ok());
  must_advance(a.world, 0.5);
  CHECK(gauge(a.world, "pressure") == Approx(1000).epsilon(1e-14));
}

TEST_CASE("a pressure set by the host gives the volume that a curve gives") {
  Block by_host(static_options()), by_curve(static_options(), Element::tet4_edge_smoothed, Curve::ramp(2500));
  REQUIRE(by_host.world.set_amount(by_host.chamber, 2500).ok());
  must_advance(by_host.world);
  must_advance(by_curve.world);
  CHECK(gauge(by_host.world, "volume") == Approx(gauge(by_curve.world, "volume")).epsilon(1e-8));
}

TEST_CASE("cancel stops a step from another thread and leaves the state alone") {
  // The progress callback is a point at which the step is certainly running.
  Block a(static_options());
  REQUIRE(a.world.step(0.1).status == StepStatus::converged);
  const auto before = a.world.save();
  REQUIRE(a.world.set_amount(a.chamber, 20000).ok());
  const std::uint64_t hash = a.world.state_hash();
  a.world.on_progress([&](const ProgressInfo&) { std::thread([&] { a.world.cancel(); }).join(); });
  const StepReport r = a.world.step(0.1);
  INFO(r.iterations << " iterations");
  CHECK(r.status == StepStatus::cancelled);
  CHECK_FALSE(r.reason.empty());
  CHECK(a.world.state_hash() == hash);
  a.world.on_progress(nullptr);
  CHECK(a.world.step(0.1).status == StepStatus::converged);
  CHECK(a.world.time() == Approx(0.2));
}

TEST_CASE("a cancel between steps stops the next one, and that alone") {
  Block a(static_options());
  a.world.cancel();
  CHECK(a.world.step(0.1).status == StepStatus::cancelled);
  CHECK(a.world.time() == 0);
  CHECK(a.world.advance(0.1).status == StepStatus::converged);
  const std::uint64_t hash = a.world.state_hash();
  a.world.cancel();
  a.world.cancel();
  const StepReport r = a.world.advance(0.1);
  CHECK(r.status == StepStatus::cancelled);
  CHECK(r.reason == "cancelled by the host");
  CHECK(r.iterations == 0);
  CHECK(r.time == Approx(0.1));
  CHECK(a.world.state_hash() == hash);
  // A step that cannot be made does not take the request.
  a.world.cancel();
  CHECK(a.world.step(-1).status == StepStatus::invalid);
  CHECK(a.world.step(0.1).status == StepStatus::cancelled);
  CHECK(a.world.step(0.1).status == StepStatus::converged);
  CHECK(a.world.time() == Approx(0.2));
}

TEST_CASE("several worlds in several threads at once give the bits that each gives alone") {
  const auto run = [](Element element) {
    Block block(dynamic_options(), element, Curve::constant(3000));
    for (int i = 0; i < 3; ++i) {
      if (block.world.step(0.01).status != StepStatus::converged) return std::uint64_t{0};
    }
    return block.world.state_hash();
  };
  std::vector<std::uint64_t> alone, together(6);
  for (int i = 0; i < 6; ++i) alone.push_back(run(kElements[i % 3]));
  std::vector<std::thread> threads;
  for (int i = 0; i < 6; ++i) {
    threads.emplace_back([&, i] { together[static_cast<std::size_t>(i)] = run(kElements[i % 3]); });
  }
  for (auto& t : threads) t.join();
  CHECK(together == alone);
  for (const std::uint64_t hash : alone) CHECK(hash != 0);
}

TEST_CASE("positions are a view, not a copy") {
  Block a(static_options());
  REQUIRE(a.world.step(0.1).status == StepStatus::converged);
  const auto* data = a.world.positions(a.body).data();
  REQUIRE(a.world.step(0.1).status == StepStatus::converged);
  CHECK(a.world.positions(a.body).data() == data);
}

TEST_CASE("progress is reported and a world can be moved") {
  Block a(static_options());
  int calls = 0;
  a.world.on_progress([&](const ProgressInfo& p) {
    ++calls;
    CHECK(p.iteration == calls);
  });
  World moved = std::move(a.world);
  const StepReport r = moved.step(0.1);
  CHECK(r.status == StepStatus::converged);
  CHECK(calls == r.iterations);
}
