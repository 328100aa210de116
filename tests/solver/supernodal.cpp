// CHOLMOD's supernodal factors, where the build has them: definite matrices, and a clear word about others.
#include <cmath>

#include "solver/linear_support.h"
#include "support/dense.h"
#include "support/worlds.h"

namespace {

using namespace isochor;
using test::Matrix;

bool built_in() {
  return make_linear_solver(Solver::cholmod_supernodal) != nullptr;
}

Matrix stiffness(int negative_nodes) {
  Matrix m = test::saddle({80, 0, false, 0, negative_nodes});
  for (Index c = 0; c < m.pattern.size; ++c) {
    for (auto k = m.pattern.column_start[at(c)]; k < m.pattern.column_start[at(c) + 1]; ++k) {
      if (m.pattern.row[static_cast<std::size_t>(k)] == c && m.values[static_cast<std::size_t>(k)] > 0)
        m.values[static_cast<std::size_t>(k)] = 20;
    }
  }
  return m;
}

struct Outcome {
  StepReport report;
  std::vector<Vec3> x;
  std::string method;
};

// A block under its weight, or pressed together along x by a part of its length.
Outcome block(Solver solver, Method method, VolumeSpace space, double poisson, double press = 0) {
  WorldOptions options = test::static_options();
  options.gravity = {0, 0, press > 0 ? -0.1 : -9.81};
  options.solver = solver;
  options.method = method;
  World world = test::make_world(options);
  BoxMeshDef def;
  def.upper = {0.4, 0.1, 0.1};
  def.divisions = {8, 2, 2};
  const BodyId body =
      test::add_body(world, test::value(box_mesh(def)), Element::tet4, test::neo_hookean(30e3, poisson));
  test::add_volume(world, body, space);
  test::hold(world, body, {"x0"});
  if (press > 0) test::hold(world, body, {"x1"}, {}, {-press * 0.4, 0, 0});
  Outcome out;
  out.report = world.advance(1);
  out.x.assign(world.positions(body).begin(), world.positions(body).end());
  out.method = world.method();
  return out;
}

double distance(const Outcome& a, const Outcome& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.x.size(); ++i) {
    const Vec3 d = a.x[i] - b.x[i];
    most = std::max(most, std::sqrt(dot(d, d)));
  }
  return most;
}

}  // namespace

TEST_CASE("supernodal factors solve definite systems again and again") {
  if (!built_in()) return;
  const auto solver = make_linear_solver(Solver::cholmod_supernodal);
  const Matrix m = stiffness(0), indefinite = stiffness(2);
  REQUIRE(solver->analyze(m.pattern).status == FactorStatus::ok);
  const std::vector<double> b = test::random_vector(m.pattern.size);
  std::vector<double> x(b.size());
  const Eigen::VectorXd exact =
      test::solve(m.dense(), Eigen::Map<const Eigen::VectorXd>(b.data(), m.pattern.size));
  for (int k = 0; k < 3; ++k) {
    const FactorReport f = solver->factor(m.values);
    REQUIRE(f.status == FactorStatus::ok);
    CHECK(f.negative_pivots == 0);
    const SolveReport s = solver->solve(b, x);
    REQUIRE(s.ok);
    CHECK(s.residual < 1e-15);
    CHECK((Eigen::Map<Eigen::VectorXd>(x.data(), exact.size()) - exact).norm() < 1e-12 * exact.norm());
    // Not definite: a wrong inertia, nothing to solve with, and no harm done.
    const FactorReport wrong = solver->factor(indefinite.values);
    CHECK(wrong.status == FactorStatus::ok);
    CHECK(wrong.negative_pivots > 0);
    CHECK_FALSE(solver->solve(b, x).ok);
    for (const double v : x) CHECK(std::isfinite(v));
  }
}

TEST_CASE("supernodal factors refuse rows in the matrix and what is not finite") {
  if (!built_in()) return;
  const auto solver = make_linear_solver(Solver::cholmod_supernodal);
  const Matrix saddle = test::saddle({20, 5, false, 0.1, 0});
  const FactorReport f = solver->analyze(saddle.pattern);
  CHECK(f.status == FactorStatus::failed);
  CHECK(f.message.find("multiplier rows") != std::string::npos);
  CHECK(solver->factor(saddle.values).status == FactorStatus::failed);
  const Matrix m = stiffness(0);
  REQUIRE(solver->analyze(m.pattern).status == FactorStatus::ok);
  std::vector<double> values = m.values;
  values[3] = std::nan("");
  CHECK(solver->factor(values).status == FactorStatus::not_finite);
  CHECK(solver->factor(m.values).status == FactorStatus::ok);
}

TEST_CASE("supernodal factors find the equilibrium of condensed and dual systems") {
  if (!built_in()) return;
  struct Case {
    Method method;
    VolumeSpace space;
    double poisson;
  };
  for (const Case& c : {Case{Method::condensation, VolumeSpace::element, 0.45},
                        Case{Method::automatic, VolumeSpace::element, 0.49},
                        Case{Method::dual_gradients, VolumeSpace::node, 0.5},
                        Case{Method::augmented_gradients, VolumeSpace::node, 0.5},
                        Case{Method::augmented_ascent, VolumeSpace::node, 0.4999}}) {
    const Outcome reference = block(Solver::eigen, Method::saddle_point, c.space, c.poisson);
    const Outcome other = block(Solver::cholmod_supernodal, c.method, c.space, c.poisson);
    INFO(other.method << ": " << other.report.reason);
    REQUIRE(other.report.status == StepStatus::converged);
    CHECK(other.method.find("cholmod_supernodal") != std::string::npos);
    CHECK(distance(reference, other) < 1e-8 * 0.4);
  }
}

TEST_CASE("a stiffness that is not definite is mended for supernodal factors as for others") {
  if (!built_in()) return;
  const Outcome reference = block(Solver::eigen, Method::condensation, VolumeSpace::element, 0.4, 0.35);
  const Outcome other =
      block(Solver::cholmod_supernodal, Method::condensation, VolumeSpace::element, 0.4, 0.35);
  INFO(other.report.reason << other.report.shifted);
  REQUIRE(reference.report.status == StepStatus::converged);
  REQUIRE(other.report.status == StepStatus::converged);
  CHECK(reference.report.shifted + reference.report.projected > 0);
  CHECK(other.report.shifted == reference.report.shifted);
  CHECK(other.report.projected == reference.report.projected);
  CHECK(distance(reference, other) < 1e-8 * 0.4);
}

TEST_CASE("supernodal factors and kept rows are refused with the remedy") {
  if (!built_in()) {
    WorldOptions options = test::static_options();
    options.solver = Solver::cholmod_supernodal;
    const auto world = World::create(options);
    REQUIRE_FALSE(world);
    CHECK(world.error().find("not part of this build") != std::string::npos);
    return;
  }
  const Outcome refused = block(Solver::cholmod_supernodal, Method::saddle_point, VolumeSpace::node, 0.5);
  CHECK(refused.report.status == StepStatus::invalid);
  CHECK(refused.report.reason.find("dual_gradients") != std::string::npos);
}
