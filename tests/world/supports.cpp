// Prescribed motions: oblique directions, several effects on one node, rotations.
#include <cmath>
#include <numbers>
#include <random>

#include "engine/base/base.h"
#include "support/worlds.h"

using namespace isochor;
using namespace test;

namespace {

struct Block {
  World world = make_world(static_options());
  BodyId body = add_body(world, box({2, 2, 2}), Element::tet4, neo_hookean(1e5, 0.4));

  EffectId move(const std::string& name, const Vec3& node, std::vector<Vec3> directions,
                const Vec3& displacement) {
    DirichletDef def;
    def.name = name;
    def.where.nearest = {node};
    def.directions = std::move(directions);
    def.displacement = displacement;
    def.amount = Curve::ramp(1);
    return value(world.add(dirichlet(def)));
  }
};

}  // namespace

TEST_CASE("oblique directions move as told and leave the rest free") {
  const Vec3 first{1, 1, 0}, second{1, 0, 0.5}, told{0.06, -0.02, 0.04};
  Block b;
  add_volume(b.world, b.body);
  hold(b.world, b.body, {"x0"});
  b.move("both", {1, 1, 1}, {first, second}, told);
  must_advance(b.world);
  const Vec3 u = displacement_at(b.world, b.body, {1, 1, 1});
  CHECK(dot(u, first) == Approx(dot(told, first)).epsilon(1e-9));
  CHECK(dot(u, second) == Approx(dot(told, second)).epsilon(1e-9));
  // The third direction is not given: nothing pulls there.
  const Vec3 free = cross(first, second);
  CHECK(std::abs(dot(u, free) - dot(told, free)) > 1e-3);
}

TEST_CASE("two effects may share a node in different directions") {
  const Vec3 first{1, 1, 0}, second{0, 1, 0};
  Block b;
  add_volume(b.world, b.body);
  hold(b.world, b.body, {"x0"});
  const EffectId one = b.move("one", {1, 1, 1}, {first}, {0.05, 0.05, 0});
  b.move("two", {1, 1, 1}, {second}, {0, -0.03, 0});
  must_advance(b.world);
  const Vec3 u = displacement_at(b.world, b.body, {1, 1, 1});
  CHECK(dot(u, first) == Approx(0.1).epsilon(1e-9));
  CHECK(u.y == Approx(-0.03).epsilon(1e-9));
  CHECK(std::abs(b.world.reaction(one)[0].x) > 1);
}

TEST_CASE("a rotation is a rotation at every amount") {
  Block b;
  add_volume(b.world, b.body);
  hold(b.world, b.body, {"x0"});
  DirichletDef turn;
  turn.where.surfaces = {"x1"};
  turn.axis_point = {0, 0.5, 0.5};
  turn.axis = {2, 0, 0};
  turn.angle = 0.8;
  turn.displacement = {0.1, 0, 0};
  turn.amount = Curve::ramp(1);
  value(b.world.add(dirichlet(turn)));
  for (const double amount : {0.5, 1.0}) {
    must_advance(b.world, 0.5);
    const double angle = 0.8 * amount, y = 0.5, z = 0.5;  // the corner (1, 1, 1) seen from the axis
    const Vec3 u = displacement_at(b.world, b.body, {1, 1, 1});
    CHECK(u.x == Approx(0.1 * amount).epsilon(1e-9));
    CHECK(u.y == Approx(std::cos(angle) * y - std::sin(angle) * z - y).epsilon(1e-9));
    CHECK(u.z == Approx(std::sin(angle) * y + std::cos(angle) * z - z).epsilon(1e-9));
  }
}

TEST_CASE("a linear body that is moved within a short step takes one iteration") {
  // The inertia of the nodes that are moved is part of the merit: without it no full step would be accepted.
  for (const bool consistent : {false, true}) {
    WorldOptions options;
    options.scheme = implicit_euler();
    options.consistent_mass = consistent;
    ElasticConstants elastic;
    elastic.young = 1e5;
    elastic.poisson = 0.3;
    World world = make_world(options);
    const BodyId body = add_body(world, box({2, 2, 2}), Element::tet4, value(isochor::linear(elastic)));
    DirichletDef def;
    def.where.surfaces = {"x0"};
    def.displacement = {0.01, 0, 0};
    def.amount = Curve::ramp(1, 1e-4);
    value(world.add(dirichlet(def)));
    const StepReport report = world.step(1e-4);
    CHECK(report.status == StepStatus::converged);
    CHECK(report.iterations == 1);
    CHECK(displacement_at(world, body, {0, 0, 0}).x == Approx(0.01).epsilon(1e-12));
  }
}

TEST_CASE("half a turn goes the way that was told") {
  const auto twisted = [](SupportTreatment treatment) {
    Block b;
    add_volume(b.world, b.body);
    hold(b.world, b.body, {"x0"});
    DirichletDef turn;
    turn.where.surfaces = {"x1"};
    turn.axis_point = {0, 0.5, 0.5};
    turn.axis = {1, 0, 0};
    turn.angle = std::numbers::pi;
    turn.amount = Curve::ramp(1);
    turn.treatment = treatment;
    value(b.world.add(dirichlet(turn)));
    return b;
  };
  for (const auto treatment : {SupportTreatment::eliminated, SupportTreatment::multiplier}) {
    Block b = twisted(treatment);
    // One step cannot tell the way round, and says so; nothing has moved.
    const StepReport refused = b.world.step(1);
    CHECK(refused.status == StepStatus::invalid);
    CHECK(refused.reason.find("3.14") != std::string::npos);
    CHECK(b.world.time() == 0);
    must_advance(b.world);
    // Halfway between the ends the block has turned by a quarter.
    const Vec3 u = displacement_at(b.world, b.body, {0.5, 1, 1});
    CHECK(u.y < -0.5);
    CHECK(std::abs(u.z) < 0.4);
  }
}

TEST_CASE("the way of a bone is summed over its keyframes") {
  const double h = std::sqrt(0.5);
  PoseTrack track;
  track.keys = {{0, {}, {1, 0, 0, 0}}, {1, {}, {h, h, 0, 0}}, {2, {}, {1, 0, 0, 0}}, {4, {}, {0, 1, 0, 0}}};
  CHECK(turned(track, 0, 4) == Approx(2 * std::numbers::pi).epsilon(1e-7));
  CHECK(turned(track, 0.5, 1.5) == Approx(0.5 * std::numbers::pi).epsilon(1e-7));
  CHECK(turned(track, 3, 9) == Approx(0.5 * std::numbers::pi).epsilon(1e-7));
  CHECK(turned(track, 4, 9) == 0);
}

TEST_CASE("a pose moves a support in the directions that it holds, and in no other") {
  // The judge: a support whose definition says the same motion, for single directions and planes.
  std::mt19937 random(4);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int trial = 0; trial < 12; ++trial) {
    const auto vector = [&] { return Vec3{number(random), number(random), number(random)}; };
    const bool plane = trial % 2 == 1;
    DirichletDef held;
    held.name = "held";
    held.where.surfaces = {"x1"};
    held.directions = {vector()};
    if (plane) held.directions.push_back(vector());
    if (trial % 3 == 2) held.treatment = SupportTreatment::multiplier;
    DirichletDef said = held;
    said.displacement = 0.05 * vector();
    said.amount = Curve::ramp(1);
    said.axis = plane ? cross(held.directions[0], held.directions[1]) : Vec3{};
    said.angle = plane ? 0.4 : 0;
    CAPTURE(trial);
    const auto make = [&](DirichletDef def, EffectId& id) {
      World world = make_world(static_options());
      def.where.body = add_body(world, box({2, 2, 2}), Element::tet4, neo_hookean(1e5, 0.5), 1000);
      add_volume(world, def.where.body);
      hold(world, def.where.body, {"x0"});
      id = value(world.add(dirichlet(def)));
      return world;
    };
    EffectId by_pose{}, by_amount{};
    World a = make(held, by_pose), b = make(said, by_amount);
    Pose pose;
    pose.position = said.displacement;
    if (plane) {
      const Vec3 axis = (std::sin(0.5 * said.angle) / norm(said.axis)) * said.axis;
      pose.rotation = {std::cos(0.5 * said.angle), axis.x, axis.y, axis.z};
    }
    value(a.set_pose(by_pose, pose));
    must_advance(a);
    must_advance(b);
    const auto x = a.positions(BodyId{}), y = b.positions(BodyId{});
    double moved = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      CHECK_THAT(norm(x[i] - y[i]), Catch::Matchers::WithinAbs(0, 1e-8));
      moved = std::max(moved, norm(x[i] - a.mesh(BodyId{}).nodes[i]));
    }
    CHECK(moved > 1e-3);
  }
}
