// What a host reads of contacts: points, forces and partners.
#include "engine/base/base.h"
#include "support/worlds.h"

using namespace test;
using Catch::Matchers::WithinAbs;
using isochor::BodyId;
using isochor::EffectId;
using isochor::norm;
using isochor::World;

namespace {

double gauge_of(const World& world, const std::string& effect, const std::string& quantity) {
  for (const isochor::Gauge& g : world.gauges()) {
    if (g.effect == effect && g.quantity == quantity) return g.value;
  }
  FAIL("no gauge " << quantity << " of " << effect);
  return 0;
}

// Two blocks on top of each other, pressed onto a floor from above and pushed sideways.
struct Pile {
  World world = make_world(static_options());
  BodyId lower{}, upper{};
  EffectId top{}, floor{}, between{};
};

Pile pile() {
  Pile p;
  p.lower = add_body(p.world, block({0, 0, 0}, {1, 1, 1}, {2, 2, 2}), isochor::Element::tet4,
                     neo_hookean(1e5, 0.3), 1000, "lower");
  p.upper = add_body(p.world, block({0.1, 0.1, 1}, {0.9, 0.9, 1.5}, {2, 2, 2}), isochor::Element::tet4,
                     neo_hookean(1e5, 0.3), 1000, "upper");
  p.top = hold(p.world, p.upper, {"z1"}, {}, {0.005, 0, -0.05});
  hold(p.world, p.lower, {"x0"}, {{1, 0, 0}, {0, 1, 0}});
  isochor::ContactDef floor;
  floor.name = "floor";
  floor.body = p.lower;
  floor.surfaces = {"z0"};
  floor.obstacle.shape = isochor::ObstacleShape::plane;
  floor.obstacle.axis = {0, 0, 1};
  floor.friction = 0.4;
  p.floor = value(p.world.add(isochor::contact(floor)));
  isochor::SurfaceContactDef between;
  between.name = "between";
  between.body = p.upper;
  between.surfaces = {"z0"};
  between.against = p.lower;
  between.against_surfaces = {"z1"};
  between.friction = 0.3;
  p.between = value(p.world.add(isochor::surface_contact(between)));
  must_advance(p.world);
  return p;
}

}  // namespace

TEST_CASE("points of contacts add up to what effects and supports report", "[contacts]") {
  Pile p = pile();
  const auto points = p.world.contacts();
  REQUIRE(points.size() > 8);
  isochor::Vec3 on_upper{}, on_lower_from_floor{};
  int nodes = 0;
  for (const auto& c : points) {
    CHECK_THAT(norm(c.normal), WithinAbs(1, 1e-9));
    CHECK(dot(c.normal, c.normal_force) > 0);
    CHECK(norm(c.friction) <= 0.4 * norm(c.normal_force) * (1 + 1e-6));
    const isochor::Vec3 force = c.normal_force + c.friction;
    if (c.effect == p.floor) {
      CHECK(c.body == "lower");
      CHECK(c.partner == "obstacle of floor");
      CHECK_THAT(c.normal.z, WithinAbs(1, 1e-12));
      CHECK_THAT(c.gap, WithinAbs(0, 1e-9));
      REQUIRE(c.node >= 0);
      CHECK(norm(c.position - p.world.positions(p.lower)[static_cast<std::size_t>(c.node)]) == 0);
      on_lower_from_floor += force;
      ++nodes;
    } else {
      CHECK(c.effect == p.between);
      CHECK(((c.body == "upper" && c.partner == "lower") || (c.body == "lower" && c.partner == "upper")));
      CHECK(c.gap < 0);
      on_upper += (c.body == "upper" ? 1.0 : -1.0) * force;
    }
  }
  CHECK(nodes > 0);
  // The upper block is held between its support and the lower one.
  CHECK_THAT(norm(on_upper + p.world.reaction(p.top)[0]), WithinAbs(0, 1e-5 * norm(on_upper)));
  for (int k = 0; k < 3; ++k) {
    const std::string axis = std::string("force_") + "xyz"[k];
    CHECK_THAT(on_lower_from_floor[k], WithinAbs(gauge_of(p.world, "floor", axis), 1e-9));
    CHECK_THAT(on_upper[k], WithinAbs(gauge_of(p.world, "between", axis), 1e-9 * norm(on_upper)));
  }
  const auto pairs = p.world.contact_pairs();
  REQUIRE(pairs.size() == 2);
  for (const auto& pair : pairs) {
    const bool floor = pair.partner == "obstacle of floor";
    const isochor::Vec3 expected =
        floor ? on_lower_from_floor : (pair.body == "upper" ? 1.0 : -1.0) * on_upper;
    CHECK_THAT(norm(pair.force - expected), WithinAbs(0, 1e-9 * norm(expected)));
    CHECK(pair.points > 0);
  }
}

TEST_CASE("what does not touch has no points", "[contacts]") {
  World world = make_world(static_options());
  const BodyId body = add_body(world, box({1, 1, 1}), isochor::Element::tet4, neo_hookean(1e5, 0.3));
  hold(world, body, {"z1"});
  isochor::ContactDef floor;
  floor.body = body;
  floor.surfaces = {"z0"};
  floor.obstacle.shape = isochor::ObstacleShape::plane;
  floor.obstacle.position = {0, 0, -1};
  floor.obstacle.axis = {0, 0, 1};
  value(world.add(isochor::contact(floor)));
  must_advance(world);
  CHECK(world.contacts().empty());
  CHECK(world.contact_pairs().empty());
}
