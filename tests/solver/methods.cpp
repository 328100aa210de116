// Every method ends at the same solution of the same model.
#include <cmath>
#include <string>

#include "support/worlds.h"

namespace {

using namespace isochor;

struct Outcome {
  StepReport report;
  std::vector<Vec3> x;
  std::string method;
  double pressure = 0;
};

double distance(const Outcome& a, const Outcome& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.x.size(); ++i) {
    const Vec3 d = a.x[i] - b.x[i];
    most = std::max(most, std::sqrt(dot(d, d)));
  }
  return most;
}

const Method kMethods[] = {Method::condensation, Method::dual_gradients, Method::augmented_gradients,
                           Method::dual_ascent, Method::augmented_ascent};

Outcome finish(World& world, BodyId body) {
  Outcome out;
  out.report = world.advance(1);
  out.x.assign(world.positions(body).begin(), world.positions(body).end());
  out.method = world.method();
  return out;
}

Outcome bend(Method method, Element element, double poisson, VolumeSpace space, double gravity = -1,
             bool dynamic = false) {
  WorldOptions options = dynamic ? test::dynamic_options() : test::static_options();
  options.gravity = {0, 0, gravity};
  options.method = method;
  World world = test::make_world(options);
  const BodyId body = test::add_body(world, test::block({}, {0.4, 0.1, 0.1}, {8, 2, 2}), element,
                                     test::neo_hookean(30e3, poisson));
  test::add_volume(world, body, space);
  test::hold(world, body, {"x0"});
  if (!dynamic) return finish(world, body);
  Outcome out;
  for (int k = 0; k < 3; ++k) {
    out.report = world.step(0.02);
    INFO(out.report.reason);
    REQUIRE(out.report.status == StepStatus::converged);
  }
  out.x.assign(world.positions(body).begin(), world.positions(body).end());
  out.method = world.method();
  return out;
}

}  // namespace

TEST_CASE("all methods bend a beam alike") {
  for (const double poisson : {0.45, 0.4999, 0.5}) {
    for (const Element element : {Element::tet4, Element::tet4_edge_smoothed}) {
      const Outcome reference = bend(Method::saddle_point, element, poisson, VolumeSpace::node);
      REQUIRE(reference.report.status == StepStatus::converged);
      for (const Method method : kMethods) {
        const Outcome other = bend(method, element, poisson, VolumeSpace::node);
        INFO(other.method << ", nu = " << poisson << ": " << other.report.reason << " iterations "
                          << other.report.iterations << ", ascents " << other.report.dual.steps
                          << ", conjugate gradients " << other.report.dual.iterations);
        CHECK(other.report.status == StepStatus::converged);
        CHECK(other.report.dual.stand_ins == 0);
        CHECK(distance(reference, other) < 1e-8 * 0.4);
      }
    }
  }
}

TEST_CASE("all methods take element rows and time steps alike") {
  const Outcome reference =
      bend(Method::saddle_point, Element::tet4, 0.45, VolumeSpace::element, -9.81, true);
  for (const Method method : kMethods) {
    const Outcome other = bend(method, Element::tet4, 0.45, VolumeSpace::element, -9.81, true);
    INFO(other.method);
    CHECK(distance(reference, other) < 1e-8 * 0.4);
  }
}

TEST_CASE("the dual methods say how much they worked") {
  const Outcome gradients = bend(Method::dual_gradients, Element::tet4, 0.5, VolumeSpace::node);
  const Outcome augmented = bend(Method::augmented_gradients, Element::tet4, 0.5, VolumeSpace::node);
  CHECK(gradients.report.dual.iterations > 0);
  CHECK(augmented.report.dual.iterations > 0);
  CHECK(augmented.report.dual.iterations < gradients.report.dual.iterations);
  const Outcome ascent = bend(Method::dual_ascent, Element::tet4, 0.5, VolumeSpace::node);
  CHECK(ascent.report.dual.steps > 1);
}

TEST_CASE("an increment that a dual method cannot solve is left to a stronger one, and told") {
  // A bonded block pressed to a fifth of its height: without its rows the stiffness is not definite.
  const auto press = [](Method method) {
    WorldOptions options = test::static_options();
    options.method = method;
    World world = test::make_world(options);
    const BodyId body = test::add_body(world, test::block({}, {0.1, 0.1, 0.1}, {4, 4, 4}), Element::tet4,
                                       test::neo_hookean(66e3, 0.5));
    test::add_volume(world, body);
    test::hold(world, body, {"x0"});
    test::hold(world, body, {"x1"}, {}, {-0.08, 0, 0});
    return finish(world, body);
  };
  const Outcome reference = press(Method::saddle_point);
  REQUIRE(reference.report.status == StepStatus::converged);
  CHECK(reference.report.dual.stand_ins == 0);
  const Outcome dual = press(Method::dual_gradients);
  INFO(dual.report.reason);
  CHECK(dual.report.status == StepStatus::converged);
  CHECK(dual.report.dual.stand_ins == 1);
  CHECK(dual.report.rejected_substeps == 0);
  CHECK(distance(reference, dual) < 1e-8 * 0.1);
}

TEST_CASE("rows that depend on each other do not send their multipliers anywhere") {
  // Of a single Tet10 with a face held one pressure mode does nothing at rest: its multiplier is what the
  // method leaves it, and must not drown the forces.
  Mesh cell;
  cell.cell_type = CellType::tet4;
  cell.nodes = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0.02, 0.03, 0.1}};
  cell.cells = {0, 1, 2, 3};
  for (const Method method : {Method::dual_gradients, Method::augmented_gradients}) {
    for (const Solver solver : {Solver::multifrontal, Solver::eigen}) {
      CAPTURE(static_cast<int>(method), static_cast<int>(solver));
      WorldOptions options = test::static_options();
      options.method = method;
      options.solver = solver;
      World world = test::make_world(options);
      const BodyId body = test::add_body(world, to_tet10(cell), Element::tet10, test::neo_hookean(1e4, 0.5));
      test::add_volume(world, body, VolumeSpace::node);
      DirichletDef held;
      held.where.body = body;
      held.where.boxes = {{Vec3{-1, -1, -1}, Vec3{1, 1, 1e-9}}};
      const EffectId base = test::value(world.add(dirichlet(held)));
      PointForceDef pull;
      pull.where.body = body;
      pull.where.nodes = {3};
      pull.force = {0.3, -0.2, 0.1};
      pull.amount = Curve::ramp(1);
      test::value(world.add(point_force(pull)));
      for (int step = 0; step < 3; ++step) {
        const StepReport r = world.advance(1.0 / 3);
        INFO(r.reason);
        REQUIRE(r.status == StepStatus::converged);
        const Vec3 left = world.reaction(base)[0] + world.time() * pull.force;
        CHECK(std::sqrt(dot(left, left)) < 1e-6);
        for (const double p : world.fields(body).node_pressure) CHECK(std::abs(p) < 1e6);
      }
    }
  }
}

// What converges linearly stops just under a tolerance, and a slender beam makes much of what is left.
TEST_CASE("an end is deeper than the tolerance asks for") {
  const auto bend_to = [](double tolerance) {
    WorldOptions options = test::static_options();
    options.gravity = {0, 0, -0.3};
    options.force_tolerance = tolerance;
    World world = test::make_world(options);
    const BodyId body = test::add_body(world, test::block({}, {1, 0.05, 0.05}, {24, 2, 2}), Element::tet10,
                                       test::neo_hookean(100e3, 0.5));
    test::add_volume(world, body, VolumeSpace::node);
    test::hold(world, body, {"x0"});
    return finish(world, body);
  };
  const Outcome rough = bend_to(1e-7), tight = bend_to(1e-11);
  REQUIRE(rough.report.status == StepStatus::converged);
  REQUIRE(tight.report.status == StepStatus::converged);
  double lowest = 0;
  for (const Vec3& x : tight.x) lowest = std::min(lowest, x.z);
  REQUIRE(lowest < -0.05);  // it bends
  CHECK(distance(rough, tight) < 1e-7);
}
