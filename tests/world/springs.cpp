// Springs and equations between points: static extension, period, bands that only pull, sums that are kept,
// refusals.
#include <cmath>
#include <numbers>

#include "support/worlds.h"

using namespace isochor;
using test::value;

namespace {

// A stiff block on rails along z, of 2 kg.
struct Block {
  World world;
  BodyId body{};

  explicit Block(const WorldOptions& options, double young = 1e9) : world(test::make_world(options)) {
    body = test::add_body(world, test::block({0, 0, 0}, {0.1, 0.1, 0.2}, {1, 1, 2}), Element::tet4,
                          test::neo_hookean(young, 0.3), 1000);
    DirichletDef rails;
    rails.where.body = body;
    rails.where.everything = true;
    rails.directions = {{1, 0, 0}, {0, 1, 0}};
    value(world.add(dirichlet(rails)));
  }
  SpringDef hanger() const {
    SpringDef def;
    def.body = body;
    def.from = {0.05, 0.05, 0.2};
    def.to = {0.05, 0.05, 0.7};
    def.stiffness = 400;
    return def;
  }
  double height() const { return world.positions(body)[0].z; }
};

template <class Def, class Make>
std::string refusal(const Def& def, Make make) {
  World world = test::make_world(test::static_options());
  test::add_body(world, test::block({0, 0, 0}, {1, 1, 1}, {1, 1, 1}), Element::tet4,
                 test::neo_hookean(1e5, 0.3));
  test::hold(world, BodyId{0}, {"x0"});
  auto added = world.add(make(def));
  if (!added) return added.error();
  const auto compiled = world.compile();
  return compiled ? "" : compiled.error();
}

}  // namespace

TEST_CASE("a weight on a spring hangs as much lower as its stiffness says") {
  for (const double free_length : {0.5, 0.3}) {
    WorldOptions options = test::static_options();
    options.gravity = {0, 0, -10};
    options.gravity_curve = Curve::ramp(1);
    Block block(options);
    SpringDef def = block.hanger();
    def.length = free_length;
    value(block.world.add(spring(def)));
    test::must_advance(block.world);
    CHECK(test::gauge(block.world, "tension") == Approx(20).epsilon(1e-9));
    CHECK(test::gauge(block.world, "length") == Approx(free_length + 20.0 / 400).epsilon(1e-9));
  }
}

TEST_CASE("a weight on a spring swings with the period of its mass") {
  const double period = 2 * std::numbers::pi * std::sqrt(2.0 / 400);
  std::vector<double> error;
  for (const int steps : {40, 80}) {
    WorldOptions options = test::dynamic_options();
    options.scheme = newmark();
    Block block(options);
    value(block.world.add(spring(block.hanger())));
    std::vector<Vec3> v(block.world.rest_positions(block.body).size(), Vec3{0, 0, 0.1});
    value(block.world.set_velocities(block.body, v));
    const double rest = block.height();
    double highest = 0;
    for (int k = 0; k < steps; ++k) {
      test::must_advance(block.world, period / steps);
      highest = std::max(highest, block.height() - rest);
    }
    CHECK(highest == Approx(0.1 * std::sqrt(2.0 / 400)).epsilon(0.02));
    error.push_back(std::abs(block.height() - rest) / highest);
    CHECK(error.back() < 0.03);
  }
  INFO(error[0] << ", " << error[1]);
  CHECK(error[0] / error[1] > 3);  // of second order
}

TEST_CASE("a band that only pulls is slack when it is short, a spring pushes") {
  for (const bool band : {true, false}) {
    Block block(test::static_options());
    SpringDef def = block.hanger();
    def.pulls_only = band;
    value(block.world.add(spring(def)));
    test::hold(block.world, block.body, {"z0"}, {{0, 0, 1}}, {0, 0, 0.1});
    test::must_advance(block.world);
    CHECK(test::gauge(block.world, "tension") == Approx(band ? 0 : -40).epsilon(1e-4).margin(1e-9));
  }
}

TEST_CASE("a spring between two bodies pulls both alike, and shortens by its amount") {
  World world = test::make_world(test::static_options());
  std::vector<EffectId> feet;
  for (int k = 0; k < 2; ++k) {
    const BodyId body =
        test::add_body(world, test::block({2.0 * k, 0, 0}, {2.0 * k + 1, 1, 1}, {1, 1, 1}), Element::tet4,
                       test::neo_hookean(1e6, 0.3), 1000, "block " + std::to_string(k));
    DirichletDef foot;
    foot.name = "foot " + std::to_string(k);
    foot.where.body = body;
    foot.where.surfaces = {k == 0 ? "x0" : "x1"};
    feet.push_back(value(world.add(dirichlet(foot))));
  }
  SpringDef def;
  def.from = {1, 0.5, 0.5};
  def.to_body = BodyId{1};
  def.to = {2, 0.5, 0.5};
  def.stiffness = 1000;
  def.amount = Curve{{{0, 1}, {1, 0.5}}};
  value(world.add(spring(def)));
  test::must_advance(world);
  const double tension = test::gauge(world, "tension");
  CHECK(tension == Approx(1000 * (test::gauge(world, "length") - 0.5)).epsilon(1e-9));
  CHECK(tension > 400);
  CHECK(world.reaction(feet[0])[0].x == Approx(-tension).epsilon(1e-6));
  CHECK(world.reaction(feet[1])[0].x == Approx(tension).epsilon(1e-6));
}

TEST_CASE("an equation between points is kept, and pulls its terms by their weights") {
  for (const double stiffness : {0.0, 500.0}) {
    World world = test::make_world(test::static_options());
    const BodyId body = test::add_body(world, test::block({0, 0, 0}, {1, 1, 1}, {2, 2, 2}),
                                       Element::tet4_edge_smoothed, test::neo_hookean(1e4, 0.4));
    const EffectId foot = test::hold(world, body, {"z0"});
    LinearConstraintDef def;
    def.terms = {{body, {0, 0.5, 1}, {0, 0, 2}, 1}, {body, {1, 0.5, 1}, {1, 0, 0}, -2}};
    def.value = 0.1;
    def.stiffness = stiffness;
    value(world.add(linear_constraint(def)));
    test::must_advance(world);
    const double up = test::displacement_at(world, body, {0, 0.5, 1}).z,
                 along = test::displacement_at(world, body, {1, 0.5, 1}).x;
    const double multiplier = test::gauge(world, "multiplier");
    INFO("stiffness " << stiffness);
    CHECK(up - 2 * along - (stiffness > 0 ? multiplier / stiffness : 0) == Approx(0.1).epsilon(1e-9));
    CHECK(std::abs(multiplier) > 1);
    // Forces -multiplier and +2 multiplier on the body, against the foot.
    CHECK(world.reaction(foot)[0].z == Approx(multiplier).epsilon(1e-6));
    CHECK(world.reaction(foot)[0].x == Approx(-2 * multiplier).epsilon(1e-6));
  }
}

TEST_CASE("springs and equations refuse what they cannot mean, by name") {
  SpringDef s;
  s.from = {1, 0.5, 0.5};
  s.to = {2, 0.5, 0.5};
  CHECK(refusal(s, spring).find("spring \"spring\": stiffness = 0 N/m") == 0);
  s.stiffness = 1;
  CHECK(refusal(s, spring).empty());
  s.length = -1;
  CHECK(refusal(s, spring).find("length = -1 m") != std::string::npos);
  s.length.reset();
  s.amount = Curve::constant(-0.5);
  CHECK(refusal(s, spring).find("amount -0.5") != std::string::npos);
  s.amount = Curve::constant(1);
  s.to = s.from;
  CHECK(refusal(s, spring).find("its ends coincide at rest") != std::string::npos);
  s.from = {9, 9, 9};
  CHECK(refusal(s, spring).find("spring \"spring\"") != std::string::npos);
  s.from = {1, 0.5, std::nan("")};
  CHECK(refusal(s, spring).find("finite numbers") != std::string::npos);
  LinearConstraintDef c;
  CHECK(refusal(c, linear_constraint).find("linear constraint \"constraint\": it has no terms") == 0);
  c.terms = {{BodyId{0}, {1, 0.5, 0.5}, {0, 0, 0}, 1}};
  CHECK(refusal(c, linear_constraint).find("terms[0].direction has no length") != std::string::npos);
  c.terms[0].direction = {1, 0, 0};
  c.terms[0].weight = 0;
  CHECK(refusal(c, linear_constraint).find("terms[0].weight = 0") != std::string::npos);
  c.terms[0].weight = 1;
  CHECK(refusal(c, linear_constraint).empty());
  c.stiffness = -1;
  CHECK(refusal(c, linear_constraint).find("stiffness = -1 N/m") != std::string::npos);
}
