// Friction as part of unsymmetric linear systems: the solution of lagged friction, in fewer iterations.
#include <cmath>
#include <cstring>

#include "support/contact_scenes.h"

namespace {

using namespace isochor;

constexpr FrictionCoupling kBoth[] = {FrictionCoupling::lagged, FrictionCoupling::coupled};

struct Run {
  World world;
  std::vector<BodyId> bodies;
  int iterations = 0, corrections = 0, lagged = 0;

  void advance(double h) {
    const StepReport r = test::must_advance(world, h);
    iterations += r.iterations;
    corrections += r.corrections;
    lagged += r.lagged;
  }
};

// Farthest that a node of one world is from the same of the other.
double distance(const Run& a, const Run& b) {
  double worst = 0;
  for (const BodyId body : a.bodies) {
    const auto x = a.world.positions(body), y = b.world.positions(BodyId{body.number()});
    for (std::size_t i = 0; i < x.size(); ++i)
      worst = std::max(worst, std::sqrt(dot(x[i] - y[i], x[i] - y[i])));
  }
  return worst;
}

WorldOptions precise(WorldOptions options) {
  options.force_tolerance = 1e-12;
  options.row_tolerance = 1e-12;
  return options;
}

// A block on a slope of 30 degrees, on a floor that is hard or soft.
Run incline(double friction, double compliance, FrictionCoupling coupling, int threads = 1,
            Solver solver = Solver::automatic) {
  WorldOptions options = precise(test::dynamic_options());
  options.gravity = {9.81 * 0.5, 0, -9.81 * std::sqrt(0.75)};
  options.threads = threads;
  options.solver = solver;
  Run r{test::make_world(options), {}};
  const BodyId body = test::add_body(r.world, test::block({-0.1, -0.05, 0}, {0.1, 0.05, 0.04}, {6, 3, 2}),
                                     Element::tet4_edge_smoothed, test::neo_hookean(1e5, 0.49));
  r.bodies.push_back(body);
  test::add_volume(r.world, body);
  ContactDef floor;
  floor.body = body;
  floor.surfaces = {"z0"};
  floor.friction = friction;
  floor.compliance = compliance;
  floor.coupling = coupling;
  test::value(r.world.add(contact(floor)));
  return r;
}

// A block of rubber, squeezed between a rough floor and a rough ball that goes down and sideways.
Run pressed(FrictionCoupling coupling, double poisson = 0.5) {
  Run r{test::make_world(precise(test::static_options())), {}};
  const BodyId body = test::add_body(r.world, test::block({-0.1, -0.1, 0}, {0.1, 0.1, 0.1}, {5, 5, 3}),
                                     Element::tet4_edge_smoothed, test::neo_hookean(1e5, poisson));
  r.bodies.push_back(body);
  test::add_volume(r.world, body);
  test::hold(r.world, body, {"z0"});
  ContactDef tool;
  tool.body = body;
  tool.surfaces = {"z1"};
  tool.friction = 0.5;
  tool.coupling = coupling;
  tool.obstacle.shape = ObstacleShape::sphere;
  tool.obstacle.radius = 0.12;
  tool.obstacle.position = {0.003, 0.002, 0.22};
  tool.obstacle.motion.keys = {{0, {0, 0, 0}, {1, 0, 0, 0}}, {1, {0.02, 0, -0.02}, {1, 0, 0, 0}}};
  test::value(r.world.add(contact(tool)));
  return r;
}

// Two blocks whose faces do not match, pressed together and sheared until part of them slides.
Run sheared(FrictionCoupling coupling) {
  Run r{test::make_world(precise(test::static_options())), {}};
  const auto material = test::neo_hookean(1e5, 0.3);
  const BodyId low = test::add_body(r.world, test::block({0, 0, 0}, {1, 1, 0.5}, {3, 3, 2}), Element::tet4,
                                    material, 1000, "lower");
  const BodyId high = test::add_body(r.world, test::block({0.1, 0.1, 0.5}, {0.9, 0.9, 1}, {4, 4, 2}),
                                     Element::tet4, material, 1000, "upper");
  r.bodies = {low, high};
  test::hold(r.world, low, {"z0"});
  test::hold(r.world, high, {"z1"}, {}, {0.05, 0, -0.05});
  SurfaceContactDef touch;
  touch.body = low;
  touch.surfaces = {"z1"};
  touch.against = high;
  touch.against_surfaces = {"z0"};
  touch.friction = 0.4;
  touch.coupling = coupling;
  test::value(r.world.add(surface_contact(touch)));
  return r;
}

}  // namespace

TEST_CASE("coupled friction ends where lagged friction ends: a block on a slope that sticks or slides") {
  for (const double friction : {0.3, 0.8}) {
    for (const double compliance : {0.0, 1e-7}) {
      INFO("friction " << friction << ", compliance " << compliance);
      Run lagged = incline(friction, compliance, FrictionCoupling::lagged),
          coupled = incline(friction, compliance, FrictionCoupling::coupled);
      for (int k = 0; k < 40; ++k) {
        lagged.advance(0.01);
        coupled.advance(0.01);
        REQUIRE(distance(lagged, coupled) < 1e-8 * 0.1);
      }
      CHECK(test::gauge(coupled.world, "friction_force") ==
            Approx(test::gauge(lagged.world, "friction_force")).epsilon(1e-6));
      CHECK(test::gauge(coupled.world, "friction_force") > 0.1);
      // What sticks to a plane has nothing that lags.
      if (friction < 0.5)
        CHECK(coupled.iterations + coupled.corrections < lagged.iterations + lagged.corrections);
    }
  }
}

TEST_CASE("coupled friction ends where lagged friction ends: a ball pressed into a block and dragged") {
  Run lagged = pressed(FrictionCoupling::lagged), coupled = pressed(FrictionCoupling::coupled);
  for (int k = 0; k < 4; ++k) {
    lagged.advance(0.25);
    coupled.advance(0.25);
    CHECK(distance(lagged, coupled) < 1e-8 * 0.2);
  }
  CHECK(test::gauge(coupled.world, "friction_force") > 1);
  CHECK(coupled.iterations + coupled.corrections < lagged.iterations + lagged.corrections);
}

TEST_CASE("coupled friction ends where lagged friction ends: two soft blocks sheared against each other") {
  Run lagged = sheared(FrictionCoupling::lagged), coupled = sheared(FrictionCoupling::coupled);
  for (int k = 0; k < 4; ++k) {
    lagged.advance(0.25);
    coupled.advance(0.25);
    CHECK(distance(lagged, coupled) < 1e-8);
  }
  CHECK(test::gauge(coupled.world, "friction_force") > 100);
  // Steps this large are spent on what touches; the end is as short either way, since corrections of lagged
  // friction know its derivatives.
  CHECK(coupled.iterations + coupled.corrections <= lagged.iterations + lagged.corrections);
}

TEST_CASE("coupled friction rolls a rigid ball as lagged friction does") {
  std::vector<Run> runs;
  for (const FrictionCoupling coupling : kBoth) {
    WorldOptions options = precise(test::dynamic_options());
    options.gravity = {2, 0, -9};
    runs.push_back({test::make_world(options), {}});
    Run& r = runs.back();
    r.bodies.push_back(test::add_body(r.world, test::block({-0.3, -0.1, -0.1}, {0.3, 0.1, 0}, {8, 3, 2}),
                                      Element::tet4, test::neo_hookean(1e5, 0.4)));
    test::hold(r.world, r.bodies[0], {"z0"});
    RigidBodyDef ball;
    ball.name = "ball";
    ball.shape.shape = ObstacleShape::sphere;
    ball.shape.radius = 0.05;
    ball.shape.position = {-0.15, 0.004, 0.051};
    test::value(r.world.add(rigid_body(ball)));
    ContactDef touch;
    touch.body = r.bodies[0];
    touch.surfaces = {"z1"};
    touch.against = "ball";
    touch.friction = 0.5;
    touch.coupling = coupling;
    test::value(r.world.add(contact(touch)));
  }
  for (int k = 0; k < 30; ++k) {
    for (Run& r : runs) r.advance(0.005);
    REQUIRE(distance(runs[0], runs[1]) < 1e-8 * 0.6);
  }
  CHECK(test::gauge(runs[1].world, "turn") > 0.1);
  CHECK(runs[1].iterations + runs[1].corrections < runs[0].iterations + runs[0].corrections);
}

// The last step of a slow path: residuals of Newton's iterations, each with factors of its own.
TEST_CASE("Newton's method with coupled friction ends quadratically, with lagged friction it does not") {
  for (const FrictionCoupling coupling : kBoth) {
    const test::Compiled scene = test::rubber_under_ball(0, 0.5, coupling);
    const System& s = *scene.system;
    CHECK(s.couples() == (coupling == FrictionCoupling::coupled));
    const TbbParallel parallel(1);
    const auto newton = test::newton_of(scene, parallel);
    test::ProblemData data(s);
    data.at_time(s, 1);
    std::vector<Vec3> x = s.parts().rest;
    const std::vector<Vec3> before = x;
    std::vector<double> lambda(at(s.rows()), 0);
    SaddleProblem problem = data.problem();
    problem.increment.t1 = 1;
    problem.increment = {0, before, 0, 1};
    SaddleOptions options;
    options.corrections = false;
    options.force_tolerance = 1e-13;
    options.row_tolerance = 1e-13;
    std::vector<double> residual;
    newton->progress = [&](int, double force, double) { residual.push_back(force); };
    const SaddleReport report = newton->solve(problem, options, x, lambda);
    INFO("residuals " << Catch::Detail::stringify(residual));
    REQUIRE(report.status == SaddleStatus::converged);
    // How often a residual below 1e-2 is more than cut to a hundredth.
    int near = 0, fast = 0;
    for (std::size_t k = 1; k < residual.size(); ++k) {
      if (residual[k - 1] > 1e-2 || residual[k - 1] < 1e-9) continue;
      ++near;
      fast += residual[k] < 1e-2 * residual[k - 1];
    }
    if (coupling == FrictionCoupling::coupled) {
      CHECK(report.lagged == 0);
      CHECK(near >= 1);
      CHECK(fast == near);
      // The exponent of the end.
      const std::size_t n = residual.size();
      CHECK(residual[n - 1] < 20 * std::pow(residual[n - 2], 1.8) + 1e-13);
    } else {
      CHECK(near > 3);
      CHECK(fast < near);
    }
  }
}

TEST_CASE("coupled friction has the same bits on one and two threads and after a checkpoint") {
  Run one = incline(0.3, 0, FrictionCoupling::coupled, 1),
      two = incline(0.3, 0, FrictionCoupling::coupled, 2);
  std::vector<std::byte> saved;
  for (int k = 0; k < 12; ++k) {
    if (k == 6) saved = one.world.save();
    one.advance(0.01);
    two.advance(0.01);
    CHECK(one.world.state_hash() == two.world.state_hash());
  }
  Run again = incline(0.3, 0, FrictionCoupling::coupled);
  REQUIRE(again.world.load(saved));
  for (int k = 6; k < 12; ++k) again.advance(0.01);
  CHECK(again.world.state_hash() == one.world.state_hash());
}

TEST_CASE("the factors that every build has do for coupled friction") {
  Run own = incline(0.3, 0, FrictionCoupling::coupled, 1, Solver::eigen),
      best = incline(0.3, 0, FrictionCoupling::coupled);
  for (int k = 0; k < 10; ++k) {
    own.advance(0.01);
    best.advance(0.01);
    CHECK(distance(own, best) < 1e-10);
  }
}

TEST_CASE("without friction nothing is coupled") {
  Run plain = incline(0, 0, FrictionCoupling::lagged), asked = incline(0, 0, FrictionCoupling::coupled);
  for (int k = 0; k < 5; ++k) {
    plain.advance(0.01);
    asked.advance(0.01);
  }
  CHECK(plain.world.state_hash() == asked.world.state_hash());
  CHECK(asked.lagged == 0);
}

TEST_CASE("what cannot take coupled friction says why") {
  const auto refused = [](const auto& change) {
    WorldOptions options = test::dynamic_options();
    change(options);
    World world = test::make_world(options);
    const BodyId body = test::add_body(world, test::block({0, 0, 0}, {1, 1, 1}, {1, 1, 1}), Element::tet4,
                                       test::neo_hookean(1e5, 0.3));
    test::hold(world, body, {"z0"});
    ContactDef touch;
    touch.body = body;
    touch.surfaces = {"z1"};
    touch.obstacle.position = {0, 0, 2};
    touch.obstacle.axis = {0, 0, -1};
    touch.friction = 0.5;
    touch.coupling = FrictionCoupling::coupled;
    test::value(world.add(contact(touch)));
    const auto r = world.compile();
    return r ? std::string() : r.error();
  };
  CHECK(refused([](WorldOptions&) {}).empty());
  CHECK(refused([](WorldOptions& o) { o.method = Method::condensation; }).empty());
  CHECK(
      refused([](WorldOptions& o) { o.solver = Solver::iterative; }) ==
      "world: \"contact\" is coupled, which makes matrices unsymmetric, and solver iterative wants symmetric "
      "ones; use another solver, or lagged");
  CHECK(refused([](WorldOptions& o) { o.scheme = continuation(); }) ==
        "world: \"contact\" is coupled, and continuation() tells stability by the inertia of a symmetric "
        "matrix; use lagged");
  CHECK(
      refused([](WorldOptions& o) { o.method = Method::position_based; }) ==
      "world: \"contact\" is coupled, and method position_based has no linear system to couple; use another "
      "method, or lagged");
  for (const Method method :
       {Method::dual_gradients, Method::augmented_gradients, Method::dual_ascent, Method::augmented_ascent}) {
    CHECK(refused([&](WorldOptions& o) {
            o.method = method;
          }).find("rests on symmetric positive definite ones; use saddle_point, or lagged") !=
          std::string::npos);
  }
}
