// Rule: no allocation in a warm step, outside the third-party solver.
#include "catch.h"
#include "rules/instruments.h"
#include "support/allocations.h"
#include "support/contact_scenes.h"
#include "support/random_saddle.h"

using namespace isochor;
using namespace test;

TEST_CASE("a warm Newton solve allocates nothing") {
  if (!allocations_are_counted()) return;
  for (const Element element : {Element::tet4, Element::tet4_edge_smoothed, Element::tet10}) {
    INFO(name_of(element));
    SmallProblem p(element, 900, std::make_unique<DenseSolver>());
    REQUIRE(p.solve(0.2).status == SaddleStatus::converged);
    p.data->at_time(*p.scene.system, 0.4);
    const SaddleProblem problem = p.data->problem();
    const AllocationCount allocations;
    const SaddleReport r = p.newton->solve(problem, {}, p.x, p.lambda);
    p.data->at_time(*p.scene.system, 0.6);
    const long count = allocations.count();
    CHECK(r.iterations > 0);
    CHECK(count == 0);
  }
}

TEST_CASE("a warm solve with friction allocates nothing, its corrections included") {
  if (!allocations_are_counted()) return;
  for (const double compliance : {0.0, 1e-7}) {
    INFO("compliance " << compliance);
    ContactDef tool = dragging_ball({0.103, 0.102, 0.22}, 0.04, 0.5);
    tool.compliance = compliance;
    const Compiled scene = rubber_under(tool, box({3, 3, 2}, {0.2, 0.2, 0.1}), 0.4);
    const System& s = *scene.system;
    const TbbParallel parallel(1);
    Newton newton(scene.system, parallel, std::make_unique<DenseSolver>());
    ProblemData data(s);
    const std::vector<Vec3> before = s.parts().rest;
    std::vector<Vec3> x = before;
    std::vector<double> lambda(at(s.rows()), 0);
    SaddleProblem problem;
    const auto solve = [&](double t) {
      problem.increment.t1 = t;
      problem.increment = {0, before, 0, t};
      SaddleOptions options;
      options.force_tolerance = options.row_tolerance = 1e-12;
      return newton.solve(problem, options, x, lambda);
    };
    data.at_time(s, 0.5);
    problem = data.problem();
    REQUIRE(solve(0.5).status == SaddleStatus::converged);
    data.at_time(s, 0.6);
    problem = data.problem();
    const AllocationCount allocations;
    const SaddleReport r = solve(0.6);
    const long count = allocations.count();
    CHECK(r.status == SaddleStatus::converged);
    INFO(r.iterations << " iterations, residuals " << r.force_residual << ", " << r.row_residual);
    CHECK(r.corrections > 0);
    CHECK(count == 0);
  }
}

TEST_CASE("warm linear systems allocate nothing, whatever the treatment of their rows") {
  if (!allocations_are_counted()) return;
  const RandomRows kept, condensed{RowTreatment::condensed}, dual{RowTreatment::augmented},
      bordered{RowTreatment::bordered, 4, Compliance::coupled, true};
  const auto made = random_system(1, {kept, condensed, dual, bordered});
  REQUIRE(made);
  const System& s = *made.value();
  const TbbParallel parallel(1);
  Assembly assembly(made.value(), parallel);
  Kkt kkt(made.value(), parallel, std::make_unique<DenseSolver>());
  const std::vector<double> stiffness(at(s.nodes()), 1.0), rows(at(s.rows()), 1.0);
  const std::vector<Vec3> nodes(at(s.nodes()), Vec3{1, 2, 3});
  const std::vector<std::uint8_t> held(at(s.rows()), 0);
  std::vector<Vec3> dx(nodes.size());
  std::vector<double> dlambda(rows.size());
  assembly.evaluate(Want::hessian, Definiteness::exact, s.parts().rest, rows, {});
  Kkt::Values values;
  values.mass_scale = 2;
  values.stiffness = stiffness;
  values.clamped = held;
  StageSeconds seconds;
  const auto run = [&] {
    return kkt.factor(assembly, values, seconds).status == FactorStatus::ok &&
           kkt.solve(nodes, rows, dx, dlambda, seconds);
  };
  REQUIRE(run());
  const AllocationCount allocations;
  const bool ok = run();
  const long count = allocations.count();
  CHECK(ok);
  CHECK(kkt.dual_iterations() > 0);
  CHECK(count == 0);
}

TEST_CASE("a step of the world allocates no more than its linear solver") {
  if (!allocations_are_counted()) return;
  // The same solver through the world and through Newton alone.
  WorldOptions options = static_options();
  options.solver = Solver::eigen;
  World world = make_world(options);
  const BodyId body = add_body(world, box({3, 1, 1}, {3, 1, 1}), Element::tet4, neo_hookean(1e5, 0.4999));
  add_volume(world, body);
  hold(world, body, {"x0"});
  TractionDef pull;
  pull.surface = "x1";
  pull.traction = {0, 900, 0};
  pull.amount = Curve::ramp(1);
  value(world.add(traction(pull)));
  SmallProblem p(Element::tet4, 900, make_linear_solver(Solver::eigen));
  REQUIRE(world.step(0.25).status == StepStatus::converged);
  REQUIRE(p.solve(0.25).status == SaddleStatus::converged);
  const AllocationCount of_world;
  const StepReport w = world.step(0.25);
  const long by_world = of_world.count();
  const AllocationCount of_newton;
  const SaddleReport n = p.solve(0.5);
  const long by_newton = of_newton.count();
  CHECK(w.factorizations == n.factorizations);
  CHECK(w.iterations == n.iterations);
  CHECK(by_world == by_newton);
}
