// Corrections on factors at hand, for matrices that differ from what was factored where bodies touch.
#include <cmath>

#include "support/contact_scenes.h"

namespace {

using namespace isochor;

struct Outcome {
  SaddleReport report;
  std::vector<Vec3> x;
  std::vector<double> lambda;
};

// A ball pressed into a block of rubber and dragged, in one increment of statics.
Outcome pressed(double compliance, double friction, FrictionCoupling coupling, bool corrections) {
  const test::Compiled scene = test::rubber_under_ball(compliance, friction, coupling);
  const System& s = *scene.system;
  const TbbParallel parallel(1);
  const auto newton = test::newton_of(scene, parallel);
  test::ProblemData data(s);
  data.at_time(s, 1);
  Outcome out;
  out.x = s.parts().rest;
  out.lambda.assign(at(s.rows()), 0);
  const std::vector<Vec3> before = out.x;
  SaddleProblem problem = data.problem();
  problem.increment.t1 = 1;
  problem.increment = {0, before, 0, 1};
  SaddleOptions options;
  options.corrections = corrections;
  options.force_tolerance = 1e-11;
  options.row_tolerance = 1e-11;
  out.report = newton->solve(problem, options, out.x, out.lambda);
  REQUIRE(out.report.status == SaddleStatus::converged);
  return out;
}

}  // namespace

TEST_CASE("corrections end where iterations with factors of their own end, with fewer of these") {
  for (const double compliance : {0.0, 1e-7}) {
    for (const double friction : {0.0, 0.5}) {
      for (const FrictionCoupling coupling : {FrictionCoupling::lagged, FrictionCoupling::coupled}) {
        if (friction == 0 && coupling == FrictionCoupling::coupled) continue;
        INFO("compliance " << compliance << ", friction " << friction << ", coupled "
                           << (coupling == FrictionCoupling::coupled));
        const Outcome with = pressed(compliance, friction, coupling, true),
                      without = pressed(compliance, friction, coupling, false);
        INFO(with.report.factorizations << " + " << with.report.corrections << " against "
                                        << without.report.factorizations);
        CHECK(with.report.corrections > 0);
        CHECK(without.report.corrections == 0);
        CHECK(with.report.factorizations < without.report.factorizations);
        double apart = 0, largest = 0, force = 0;
        for (std::size_t i = 0; i < with.x.size(); ++i) {
          const Vec3 d = with.x[i] - without.x[i];
          apart = std::max(apart, std::sqrt(dot(d, d)));
        }
        for (std::size_t r = 0; r < with.lambda.size(); ++r) {
          largest = std::max(largest, std::abs(without.lambda[r]));
          force = std::max(force, std::abs(with.lambda[r] - without.lambda[r]));
        }
        CHECK(apart < 1e-9 * 0.2);
        CHECK(force < 1e-7 * largest);
      }
    }
  }
}

// Normal forces that change with every step: with the lag held in the matrix a step takes six and more.
TEST_CASE("a slab that slides on a floor takes one factorization a step, and two or three corrections") {
  for (const double compliance : {0.0, 1e-8}) {
    INFO("compliance " << compliance);
    WorldOptions options = test::dynamic_options();
    options.gravity = {0, 0, -9.81};
    World world = test::make_world(options);
    const BodyId body = test::add_body(world, test::block({0, 0, 0}, {0.15, 0.15, 0.02}, {12, 12, 2}),
                                       Element::tet4, test::neo_hookean(1e5, 0.5));
    test::add_volume(world, body);
    DirichletDef top;
    top.where.body = body;
    top.where.surfaces = {"z1"};
    top.directions = {{1, 0, 0}};
    top.displacement = {0.02, 0, 0};
    top.amount = Curve::ramp(1, 0.3);
    test::value(world.add(dirichlet(top)));
    ContactDef floor;
    floor.body = body;
    floor.surfaces = {"z0"};
    floor.friction = 0.3;
    floor.compliance = compliance;
    test::value(world.add(contact(floor)));
    for (int k = 0; k < 5; ++k) test::must_advance(world, 0.01);
    int iterations = 0, corrections = 0;
    constexpr int steps = 10;
    for (int k = 0; k < steps; ++k) {
      const StepReport r = test::must_advance(world, 0.01);
      iterations += r.iterations;
      corrections += r.corrections;
    }
    CHECK(test::gauge(world, "friction_force") > 0.1);
    CHECK(iterations <= steps + 1);
    CHECK(corrections <= 3 * steps);
  }
}
