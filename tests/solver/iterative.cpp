// The iterative linear solver: answers of the direct one, a preconditioner that stays definite, and plain
// words when it fails.
#include <cmath>
#include <limits>

#include "engine/solvers/iterative/iterative_solver.h"
#include "solver/linear_support.h"
#include "support/dense.h"
#include "support/worlds.h"

namespace {

using namespace isochor;
using test::Matrix;

Eigen::MatrixXd dense_preconditioner(IterativeSolver& solver, Index size) {
  Eigen::MatrixXd b(size, size);
  std::vector<double> unit(at(size), 0.0), column(at(size));
  for (Index c = 0; c < size; ++c) {
    unit[at(c)] = 1;
    solver.apply_preconditioner(unit, column);
    unit[at(c)] = 0;
    b.col(c) = Eigen::Map<const Eigen::VectorXd>(column.data(), size);
  }
  return b;
}

// Definite coarse levels of a few nodes, so that small matrices have several.
IterativeOptions small_levels() {
  IterativeOptions options;
  options.multigrid.coarsest = 4;
  return options;
}

struct Bent {
  StepReport report;
  std::vector<Vec3> x;
  std::uint64_t hash = 0;
};

Bent bend(Solver solver, std::array<int, 3> divisions, int threads, const VolumeDef& def,
          Element element = Element::tet4, double poisson = 0.4999) {
  BoxMeshDef box;
  box.upper = {0.3, 0.1, 0.1};
  box.divisions = divisions;
  WorldOptions options = test::static_options();
  options.gravity = {0, 0, -9.81};
  options.solver = solver;
  options.threads = threads;
  World world = test::make_world(options);
  const BodyId body =
      test::add_body(world, test::value(box_mesh(box)), element, test::neo_hookean(100e3, poisson));
  VolumeDef rows = def;
  rows.body = body;
  test::value(world.add(volume(rows)));
  test::hold(world, body, {"x0"});
  Bent out;
  out.report = world.step(1);
  out.x.assign(world.positions(body).begin(), world.positions(body).end());
  out.hash = world.state_hash();
  return out;
}

double distance(const Bent& a, const Bent& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.x.size(); ++i) {
    const Vec3 d = a.x[i] - b.x[i];
    most = std::max(most, std::sqrt(dot(d, d)));
  }
  return most;
}

}  // namespace

TEST_CASE("minimal residuals solve saddle-point systems, a row over everything included") {
  for (const double compliance : {0.0, 1e-8, 0.3}) {
    for (const bool dense : {false, true}) {
      INFO("compliance " << compliance << ", row over everything " << dense);
      const Matrix m = test::saddle({150, 40, dense, compliance, 0});
      IterativeOptions options = small_levels();
      options.tolerance = 1e-11;
      IterativeSolver solver(options);
      REQUIRE(solver.analyze(m.pattern).status == FactorStatus::ok);
      REQUIRE(solver.factor(m.values).status == FactorStatus::ok);
      CHECK(solver.multigrid().level_count() > 1);
      const std::vector<double> b = test::random_vector(m.pattern.size);
      std::vector<double> x(b.size());
      const SolveReport s = solver.solve(b, x);
      CHECK(s.ok);
      CHECK(s.iterations > 0);
      const Eigen::VectorXd exact =
          test::solve(m.dense(), Eigen::Map<const Eigen::VectorXd>(b.data(), m.pattern.size));
      CHECK((Eigen::Map<const Eigen::VectorXd>(x.data(), exact.size()) - exact).norm() < 1e-8 * exact.norm());
    }
  }
}

TEST_CASE("what is asked for less takes fewer iterations, and is met") {
  const Matrix m = test::saddle({600, 160, false, 1e-8, 0});
  IterativeSolver solver(small_levels());
  REQUIRE(solver.analyze(m.pattern).status == FactorStatus::ok);
  REQUIRE(solver.factor(m.values).status == FactorStatus::ok);
  const std::vector<double> b = test::random_vector(m.pattern.size);
  const Eigen::Map<const Eigen::VectorXd> right(b.data(), m.pattern.size);
  std::vector<double> x(b.size());
  int before = 0;
  for (const double tolerance : {1e-1, 1e-2, 1e-4, 0.0}) {
    INFO("tolerance " << tolerance);
    const SolveReport s = solver.solve_to(tolerance, b, x);
    CHECK(s.ok);
    CHECK(s.iterations > before);
    before = s.iterations;
    const Eigen::VectorXd left =
        right - m.dense() * Eigen::Map<const Eigen::VectorXd>(x.data(), right.size());
    CHECK(left.norm() <= 1.02 * std::max(tolerance, 1e-8) * right.norm());
  }
}

TEST_CASE("the preconditioner is symmetric and definite, also where the stiffness is not") {
  for (int negative = 0; negative < 4; ++negative) {
    INFO(negative << " nodes turned negative");
    const Matrix m = test::saddle({80, 20, false, 0.1, negative});
    IterativeSolver solver(small_levels());
    REQUIRE(solver.analyze(m.pattern).status == FactorStatus::ok);
    REQUIRE(solver.factor(m.values).status == FactorStatus::ok);
    REQUIRE(solver.multigrid().level_count() > 1);
    const Eigen::MatrixXd b = dense_preconditioner(solver, m.pattern.size);
    CHECK((b - b.transpose()).norm() < 1e-12 * b.norm());
    const Eigen::VectorXd values = test::eigenvalues(b);
    CHECK(values.minCoeff() > 1e-4 * values.maxCoeff());
    const std::vector<double> right = test::random_vector(m.pattern.size);
    std::vector<double> x(right.size());
    CHECK(solver.solve(right, x).ok);
  }
}

TEST_CASE("the iterative solver says when it fails") {
  const Matrix m = test::saddle({150, 40, false, 0.1, 0});
  const std::vector<double> b = test::random_vector(m.pattern.size);
  std::vector<double> x(b.size(), 1.0);

  IterativeOptions options = small_levels();
  options.max_iterations = 2;
  IterativeSolver hurried(options);
  CHECK_FALSE(hurried.solve(b, x).ok);  // nothing factored
  CHECK(x[0] == 0);
  CHECK(hurried.factor(m.values).status == FactorStatus::failed);
  REQUIRE(hurried.analyze(m.pattern).status == FactorStatus::ok);
  REQUIRE(hurried.factor(m.values).status == FactorStatus::ok);
  const SolveReport s = hurried.solve(b, x);
  CHECK_FALSE(s.ok);
  CHECK(s.iterations == 2);
  CHECK(std::isfinite(s.residual));
  CHECK(s.residual > 1e-8);

  std::vector<double> bad = m.values;
  bad[5] = std::numeric_limits<double>::quiet_NaN();
  CHECK(hurried.factor(bad).status == FactorStatus::not_finite);
  CHECK_FALSE(hurried.solve(b, x).ok);

  // Two rows that ask for different things of the same unknown have no solution.
  Eigen::MatrixXd contradiction = Eigen::MatrixXd::Zero(5, 5);
  contradiction.topLeftCorner(3, 3) = 2 * Eigen::MatrixXd::Identity(3, 3);
  for (Eigen::Index r : {3, 4}) contradiction(r, 0) = contradiction(0, r) = 1;
  Matrix singular = test::sparse(contradiction);
  singular.pattern.multiplier = {0, 0, 0, 1, 1};
  IterativeSolver solver;
  REQUIRE(solver.analyze(singular.pattern).status == FactorStatus::ok);
  REQUIRE(solver.factor(singular.values).status == FactorStatus::ok);
  const std::vector<double> right = {0, 0, 0, 1, 2};
  std::vector<double> y(5);
  CHECK_FALSE(solver.solve(right, y).ok);
  for (const double v : y) CHECK(std::isfinite(v));
}

TEST_CASE("the iterative path arrives where the direct one does") {
  for (const double poisson : {0.45, 0.4999, 0.5}) {
    for (const Element element : {Element::tet4, Element::tet4_edge_smoothed, Element::tet10}) {
      INFO("nu " << poisson << ", element " << static_cast<int>(element));
      const Bent direct = bend(Solver::automatic, {6, 2, 2}, 1, {}, element, poisson);
      const Bent iterative = bend(Solver::iterative, {6, 2, 2}, 1, {}, element, poisson);
      INFO(iterative.report.reason);
      CHECK(iterative.report.status == StepStatus::converged);
      CHECK(iterative.report.krylov.iterations > 0);
      CHECK(direct.report.krylov.iterations == 0);
      CHECK(iterative.report.iterations <= direct.report.iterations + 2);
      CHECK(distance(direct, iterative) < 1e-8 * 0.3);
    }
  }
}

TEST_CASE("iterations hardly grow with the mesh") {
  const Bent coarse = bend(Solver::iterative, {12, 4, 4}, 0, {});
  const Bent fine = bend(Solver::iterative, {24, 8, 8}, 0, {});
  REQUIRE(coarse.report.status == StepStatus::converged);
  REQUIRE(fine.report.status == StepStatus::converged);
  const auto per_solve = [](const Bent& b) {
    return static_cast<double>(b.report.krylov.iterations) /
           static_cast<double>(b.report.iterations + b.report.corrections);
  };
  INFO(per_solve(coarse) << " and " << per_solve(fine));
  CHECK(per_solve(fine) < 1.5 * per_solve(coarse));
  CHECK(per_solve(fine) < 15);
}

TEST_CASE("the iterative solver gives the same bits at any thread count") {
  const Bent one = bend(Solver::iterative, {12, 4, 4}, 1, {});
  const Bent two = bend(Solver::iterative, {12, 4, 4}, 2, {});
  const Bent four = bend(Solver::iterative, {12, 4, 4}, 4, {});
  CHECK(one.hash == two.hash);
  CHECK(one.hash == four.hash);
  CHECK(one.report.krylov.iterations == four.report.krylov.iterations);
}
