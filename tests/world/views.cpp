// Views of positions and velocities: from compile() on they stay where they are and show the present state;
// whoever holds keep_views() reads the last numbers even where the world is gone.
#include "support/worlds.h"

using namespace isochor;
using namespace test;

namespace {

// A cube of rubber on a support, inflated from inside.
struct Cushion {
  World world;
  BodyId body{};
  EffectId chamber{};

  explicit Cushion(WorldOptions options) : world(make_world(heavy(std::move(options)))) {
    const Mesh mesh = mapped(hollow_box(false, CellType::tet4), [](const Vec3& p) { return 0.02 * p; });
    body = add_body(world, mesh, Element::tet4, neo_hookean(1e5, 0.5));
    add_volume(world, body);
    hold(world, body, {"z0"});
    CavityDef air;
    air.surfaces = {"chamber"};
    air.amount = Curve::constant(0);
    chamber = value(world.add(cavity(air)));
    value(world.compile());
  }
  static WorldOptions heavy(WorldOptions options) {
    options.gravity = {0, 0, -9.8};
    return options;
  }
};

// Where views were at the start, and whether they are there still and show what the world says.
struct Views {
  const World& world;
  BodyId body;
  std::span<const Vec3> x = world.positions(body), v = world.velocities(body);

  void check() const {
    CHECK(world.positions(body).data() == x.data());
    CHECK(world.velocities(body).data() == v.data());
    CHECK(world.positions(body).size() == x.size());
  }
};

}  // namespace

TEST_CASE("views stay where they are over steps, rejected steps, load and what a host sets") {
  WorldOptions options = dynamic_options();
  options.time_error = 1e-4;  // increments are taken back
  Cushion c(options);
  const Views views{c.world, c.body};
  const Vec3 at_rest = views.x.back();
  value(c.world.set_amount(c.chamber, 3000));
  const StepReport report = must_advance(c.world, 0.05);
  CHECK(report.error_rejections > 0);
  views.check();
  CHECK(views.x.back() != at_rest);

  const std::vector<std::byte> saved = c.world.save();
  const Vec3 when_saved = views.x.back();
  must_advance(c.world, 0.05);
  CHECK(views.x.back() != when_saved);
  value(c.world.load(saved));
  views.check();
  CHECK(views.x.back() == when_saved);

  const std::vector<Vec3> moved(views.x.size(), Vec3{1, 2, 3});
  value(c.world.set_velocities(c.body, moved));
  views.check();
  CHECK(views.v.back() == Vec3{1, 2, 3});
  value(c.world.set_positions(c.body, std::vector<Vec3>(c.world.rest_positions(c.body).begin(),
                                                        c.world.rest_positions(c.body).end())));
  views.check();
  CHECK(views.x.back() == at_rest);
}

TEST_CASE("views stay where they are when a state that a budget left unfinished is given back") {
  World world = make_world(dynamic_options());
  const BodyId body =
      add_body(world, scene_mesh("finger_small"), Element::tet4, neo_hookean(100e3, 0.5), 1070);
  add_volume(world, body);
  hold(world, body, {"clamped"});
  CavityDef air;
  air.surfaces = {"chamber"};
  const EffectId chamber = value(world.add(cavity(air)));
  value(world.compile());
  const Views views{world, body};
  StepBudget one;
  one.iterations = 1;
  value(world.set_amount(chamber, 20e3));
  REQUIRE(world.step(1.0 / 60, one).status == StepStatus::unfinished);
  views.check();
  value(world.set_amount(chamber, 1e12));
  const StepReport failed = world.advance(0.02);
  REQUIRE(failed.status == StepStatus::rejected);
  CHECK(failed.reason.find("is back") != std::string::npos);
  views.check();
}

TEST_CASE("views of a body that is gone keep their last numbers") {
  Cushion c(static_options());
  const Mesh other = block({1, 0, 0}, {1.1, 0.1, 0.1}, {2, 2, 2});
  const BodyId first = add_body(c.world, other, Element::tet4, neo_hookean(1e5, 0.3), 1000, "first");
  const EffectId held = hold(c.world, first, {"x0"});
  const std::span<const Vec3> x = c.world.positions(first);
  const std::shared_ptr<const void> keeps = c.world.keep_views();
  must_advance(c.world, 0.5);
  const std::vector<Vec3> last(x.begin(), x.end());
  // Another body with as many nodes comes in its place.
  value(c.world.remove(held));
  value(c.world.remove(first));
  const BodyId second = add_body(c.world, other, Element::tet4, neo_hookean(1e5, 0.3), 1000, "second");
  hold(c.world, second, {"y0"});
  must_advance(c.world, 0.5);
  CHECK(c.world.positions(second).data() != x.data());
  CHECK(std::equal(x.begin(), x.end(), last.begin()));
  CHECK(!std::equal(x.begin(), x.end(), c.world.positions(second).begin()));
}

TEST_CASE("numbers that somebody holds outlive their world") {
  auto c = std::make_unique<Cushion>(static_options());
  must_advance(c->world, 0.5);
  const std::span<const Vec3> x = c->world.positions(c->body);
  const std::vector<Vec3> last(x.begin(), x.end());
  const std::shared_ptr<const void> held = c->world.keep_views();
  World moved = std::move(c->world);
  CHECK(moved.positions(c->body).data() == x.data());
  moved = make_world(static_options());  // the world is gone
  c.reset();
  CHECK(std::equal(x.begin(), x.end(), last.begin()));
}
