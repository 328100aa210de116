// Statics then dynamics in one run.
#include <cmath>

#include "engine/base/base.h"
#include "numbers/cube.h"

using namespace isochor;
using test::value;

namespace {

WorldOptions options_with(SchemePtr scheme) {
  WorldOptions options = test::dynamic_options();
  options.scheme = std::move(scheme);
  return options;
}

// A bar that is pulled at its end, by a curve.
struct Pulled {
  World world;
  BodyId body{};

  Pulled(SchemePtr scheme, const Curve& pull, double viscosity = 0)
      : world(test::make_world(options_with(std::move(scheme)))) {
    body = test::add_body(world, test::block({0, 0, 0}, {1, 0.2, 0.2}, {5, 1, 1}),
                          Element::tet4_edge_smoothed, test::neo_hookean(1e5, 0.5));
    test::add_volume(world, body);
    test::hold(world, body, {"x0"});
    TractionDef def;
    def.body = body;
    def.surface = "x1";
    def.traction = {2e4, 0, 0};
    def.amount = pull;
    value(world.add(traction(def)));
    if (viscosity == 0) return;
    DampingDef damped;
    damped.body = body;
    damped.viscosity = viscosity;
    value(world.add(damping(damped)));
  }
  double end() const { return test::displacement_at(world, body, {1, 0.1, 0.1}).x; }
};

}  // namespace

TEST_CASE("a preload is an equilibrium, rests when nothing changes and swings when it is let go") {
  const Curve pull{{{0, 0}, {1, 1}, {2, 1}, {2.0001, 0}}};
  Pulled at_rest(statics(), pull);
  test::must_advance(at_rest.world, 1);
  for (const auto& scheme : {implicit_euler(), bdf2(), generalized_alpha(0.8)}) {
    // Viscosity is of no account until there is motion.
    Pulled pulled(static_until(1, scheme), pull, 50);
    INFO(pulled.world.method());
    for (int k = 0; k < 4; ++k) test::must_advance(pulled.world, 0.25);
    CHECK(pulled.end() == Approx(at_rest.end()).epsilon(1e-7));
    CHECK(pulled.world.kinetic_energy() == 0);
    const auto before = std::vector<Vec3>(pulled.world.positions(pulled.body).begin(),
                                          pulled.world.positions(pulled.body).end());
    for (int k = 0; k < 10; ++k) test::must_advance(pulled.world, 0.1);
    for (std::size_t i = 0; i < before.size(); ++i)
      CHECK(norm(pulled.world.positions(pulled.body)[i] - before[i]) < 1e-6);
    double lowest = pulled.end();
    for (int k = 0; k < 40; ++k) {
      test::must_advance(pulled.world, 0.005);
      lowest = std::min(lowest, pulled.end());
    }
    CHECK(lowest < 0);  // through where it was unloaded
  }
}

TEST_CASE("what follows a preload is what dynamics makes of that state") {
  // Against a world that is put there and let go.
  const Curve drop{{{0, 1}, {1, 1}, {1.0001, 0}}};
  Pulled one(static_until(1, bdf2()), drop);
  test::must_advance(one.world, 1);
  World other = test::make_world(options_with(bdf2()));
  const BodyId body = test::add_body(other, test::block({0, 0, 0}, {1, 0.2, 0.2}, {5, 1, 1}),
                                     Element::tet4_edge_smoothed, test::neo_hookean(1e5, 0.5));
  test::add_volume(other, body);
  test::hold(other, body, {"x0"});
  value(other.compile());
  value(other.set_positions(body, one.world.positions(one.body)));
  for (int k = 0; k < 20; ++k) {
    test::must_advance(one.world, 0.01);
    test::must_advance(other, 0.01);
    for (std::size_t i = 0; i < one.world.positions(one.body).size(); ++i)
      CHECK(norm(one.world.positions(one.body)[i] - other.positions(body)[i]) < 1e-7);
  }
}

TEST_CASE("a run of both is saved and goes on with the same bits") {
  const Curve pull{{{0, 0}, {1, 1}, {1.0001, 0}}};
  for (const double saved_at : {0.5, 1.0, 1.2}) {
    Pulled one(static_until(1, bdf2()), pull), two(static_until(1, bdf2()), pull);
    while (one.world.time() < saved_at - 1e-9) test::must_advance(one.world, 0.1);
    value(two.world.load(one.world.save()));
    for (int k = 0; k < 8; ++k) {
      test::must_advance(one.world, 0.1);
      test::must_advance(two.world, 0.1);
    }
    CHECK(one.world.state_hash() == two.world.state_hash());
    Pulled other(static_until(1.1, bdf2()), pull);
    const auto loaded = other.world.load(one.world.save());
    REQUIRE_FALSE(loaded);
    CHECK(loaded.error().find("time scheme") != std::string::npos);
  }
}

TEST_CASE("statics then dynamics refuses what has no meaning") {
  for (const auto& scheme :
       {static_until(0, bdf2()), static_until(-1, bdf2()), static_until(1, statics()),
        static_until(1, implicit_midpoint()), static_until(std::nan(""), bdf2()), static_until(1, nullptr)}) {
    WorldOptions options;
    options.scheme = scheme;
    const auto world = World::create(options);
    REQUIRE_FALSE(world);
    CHECK(world.error().find("static_until") != std::string::npos);
  }
}
