// Each treatment of rows, and all together, against the dense solution of the same saddle point.
#include <cmath>

#include "engine/solve/kkt/kkt.h"
#include "engine/solvers/front/multifrontal_solver.h"
#include "support/dense.h"
#include "support/random_saddle.h"
#include "support/worlds.h"

using namespace isochor;
using test::Compliance;
using test::RandomRows;

namespace {

constexpr double kMassScale = 2;

struct Solved {
  std::shared_ptr<const System> system;
  TbbParallel parallel{1};
  Assembly assembly;
  Kkt kkt;
  StageSeconds seconds;
  std::vector<double> stiffness;
  std::vector<Vec3> node_rhs, dx;
  std::vector<double> row_rhs, dlambda;

  Solved(std::shared_ptr<const System> of, Solver kind) : Solved(std::move(of), make_linear_solver(kind)) {}
  Solved(std::shared_ptr<const System> of, std::unique_ptr<LinearSolver> solver)
      : system(std::move(of)),
        assembly(system, parallel),
        kkt(system, parallel, std::move(solver)),
        stiffness(at(system->nodes()), 1.0),
        node_rhs(at(system->nodes())),
        dx(node_rhs.size()),
        row_rhs(at(system->rows())),
        dlambda(row_rhs.size()) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (Vec3& f : node_rhs) f = {unit(random), unit(random), unit(random)};
    for (double& g : row_rhs) g = unit(random);
    const std::vector<double> none(at(system->rows()), 0.0);
    assembly.evaluate(Want::hessian, Definiteness::exact, system->parts().rest, none, {});
  }

  Kkt::Outcome factor(std::span<const std::uint8_t> held) {
    Kkt::Values values;
    values.mass_scale = kMassScale;
    values.stiffness = stiffness;
    values.clamped = held;
    return kkt.factor(assembly, values, seconds);
  }
  bool solve(double tolerance = 0) { return kkt.solve(node_rhs, row_rhs, dx, dlambda, seconds, tolerance); }

  // What the step leaves of the node equations, with multipliers that solve their rows; relative to the
  // largest of their right-hand side. All rows are compliant.
  double left_of_nodes() {
    const System& s = *system;
    const Eigen::Index n = s.free_unknowns(), m = s.rows();
    const Eigen::MatrixXd a = test::dense_saddle(assembly, kMassScale, {});
    Eigen::VectorXd u(n), f(n);
    for (Index i = 0; i < s.nodes(); ++i) {
      const Vec3 q = s.unknowns().to_free(i, dx[at(i)]), b = s.unknowns().to_free(i, node_rhs[at(i)]);
      for (Index c = 0; c < s.unknowns().of(i); ++c) {
        u(s.unknowns().begin(i) + c) = q[c];
        f(s.unknowns().begin(i) + c) = b[c];
      }
    }
    const Eigen::Map<const Eigen::VectorXd> g(row_rhs.data(), m);
    const Eigen::VectorXd lambda = test::solve(a.bottomRightCorner(m, m), g - a.bottomLeftCorner(m, n) * u);
    const Eigen::VectorXd left = f - a.topLeftCorner(n, n) * u - a.topRightCorner(n, m) * lambda;
    return left.cwiseAbs().maxCoeff() / f.cwiseAbs().maxCoeff();
  }

  // Largest difference from the dense solution, relative to its largest entry.
  double error(std::span<const std::uint8_t> held) {
    const System& s = *system;
    const Eigen::Index n = s.free_unknowns();
    const Eigen::MatrixXd a = test::dense_saddle(assembly, kMassScale, held);
    Eigen::VectorXd b(a.rows());
    for (Index i = 0; i < s.nodes(); ++i) {
      const Vec3 q = s.unknowns().to_free(i, node_rhs[at(i)]);
      for (Index c = 0; c < s.unknowns().of(i); ++c) b(s.unknowns().begin(i) + c) = q[c];
    }
    for (Index r = 0; r < s.rows(); ++r) b(n + r) = row_rhs[at(r)];
    const Eigen::VectorXd u = test::solve(a, b);
    double worst = 0;
    for (Index i = 0; i < s.nodes(); ++i) {
      const Vec3 q = s.unknowns().to_free(i, dx[at(i)]);
      for (Index c = 0; c < 3; ++c) {
        const double dense = c < s.unknowns().of(i) ? u(s.unknowns().begin(i) + c) : 0;
        worst = std::max(worst, std::abs(q[c] - dense));
      }
    }
    for (Index r = 0; r < s.rows(); ++r) worst = std::max(worst, std::abs(dlambda[at(r)] - u(n + r)));
    return worst / u.cwiseAbs().maxCoeff();
  }
  Index negative_eigenvalues(std::span<const std::uint8_t> held) {
    return test::negative_eigenvalues(test::dense_saddle(assembly, kMassScale, held));
  }
  // Every third row of a treatment that can be held, from `first` on.
  std::vector<std::uint8_t> some_held(std::size_t first) const {
    std::vector<std::uint8_t> held(row_rhs.size(), 0);
    for (std::size_t r = first; r < held.size(); r += 3) held[r] = 1;
    for (const Index r : system->treated().bordered) held[at(r)] = 0;
    return held;
  }
};

const RandomRows kept_hard{RowTreatment::saddle, 5, Compliance::none};
const RandomRows kept_coupled{RowTreatment::saddle, 6, Compliance::coupled};
const RandomRows condensed{RowTreatment::condensed, 7, Compliance::diagonal};
const RandomRows bordered_hard{RowTreatment::bordered, 3, Compliance::none, true};
const RandomRows bordered_coupled{RowTreatment::bordered, 4, Compliance::coupled, true};
const RandomRows dual_hard{RowTreatment::dual, 5, Compliance::none};
const RandomRows dual_coupled{RowTreatment::dual, 6, Compliance::coupled};
const RandomRows augmented_hard{RowTreatment::augmented, 5, Compliance::none};
const RandomRows augmented_coupled{RowTreatment::augmented, 6, Compliance::coupled};

struct Case {
  const char* name;
  std::vector<RandomRows> rows;
};
const std::vector<Case> cases{
    {"no rows", {}},
    {"kept", {kept_hard, kept_coupled}},
    {"condensed", {condensed}},
    {"bordered", {bordered_hard, bordered_coupled}},
    {"dual", {dual_hard, dual_coupled}},
    {"augmented", {augmented_hard, augmented_coupled}},
    {"kept, condensed, bordered", {condensed, kept_hard, bordered_coupled, kept_coupled}},
    {"condensed, bordered, dual", {dual_coupled, condensed, bordered_hard}},
    {"all", {augmented_coupled, bordered_coupled, condensed, kept_hard}},
};

}  // namespace

TEST_CASE("steps and multipliers of every treatment are those of the dense saddle point") {
  for (const Case& c : cases) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const auto system = test::value(test::random_system(seed, c.rows));
      Solved s(system, Solver::automatic);
      for (const bool hold : {false, true, false}) {
        const auto held = hold ? s.some_held(seed % 3) : std::vector<std::uint8_t>{};
        INFO(c.name << ", seed " << seed << (hold ? ", some rows held" : ""));
        const Kkt::Outcome f = s.factor(held);
        INFO(f.message);
        REQUIRE(f.status == FactorStatus::ok);
        REQUIRE(s.solve());
        CHECK(s.error(held) < 1e-8);
        if (f.negative >= 0) CHECK(f.negative == s.negative_eigenvalues(held));
      }
    }
  }
}

// Factors in single precision, so that there is something left to refine.
TEST_CASE("a tolerance is of the forces asked for, however stiff the rows that are eliminated") {
  for (const double softness : {1.0, 1e-5, 1e-6}) {
    RandomRows stiff = condensed;
    stiff.softness = softness;
    for (unsigned seed = 1; seed <= 5; ++seed) {
      INFO("softness " << softness << ", seed " << seed);
      const auto system = test::value(test::random_system(seed, {stiff}, 60));
      Solved s(system, std::make_unique<MultifrontalSolver>(make_linear_solver(Solver::eigen),
                                                            MultifrontalOptions{.single_from = 0}));
      REQUIRE(s.factor({}).status == FactorStatus::ok);
      REQUIRE(s.solve());  // new factors are proven by a full refinement
      REQUIRE(s.solve(1e-4));
      // The tolerance is in scaled unknowns, where stiff directions count for less.
      CHECK(s.left_of_nodes() <= 1e-2);
    }
  }
}

TEST_CASE("a system whose held rows are others than the factors hold is solved beside them") {
  const RandomRows kept{RowTreatment::saddle, 6, Compliance::diagonal, false, true};
  const RandomRows soft{RowTreatment::condensed, 6, Compliance::diagonal, false, true};
  for (unsigned seed = 1; seed <= 3; ++seed) {
    INFO("seed " << seed);
    const auto system = test::value(test::random_system(seed, {kept, soft, kept_hard}));
    Solved s(system, Solver::multifrontal);
    REQUIRE(s.kkt.coupled_possible());
    const auto first = s.some_held(0), next = s.some_held(1);
    s.kkt.prepare_coupled();
    REQUIRE(s.factor(first).status == FactorStatus::ok);
    CHECK(s.kkt.holds(first));
    CHECK_FALSE(s.kkt.holds(next));
    for (const auto& held : {next, std::vector<std::uint8_t>{}, first}) {
      REQUIRE(s.kkt.solve_coupled(nullptr, held, s.node_rhs, s.row_rhs, 1e-12, s.dx, s.dlambda, s.seconds));
      CHECK(s.error(held) < 1e-8);
    }
  }
  // A row that its compliance ties to others stays as the factors have it.
  const auto tied = test::value(
      test::random_system(1, {RandomRows{RowTreatment::saddle, 6, Compliance::coupled, false, true}}));
  Solved s(tied, Solver::multifrontal);
  s.kkt.prepare_coupled();
  REQUIRE(s.factor({}).status == FactorStatus::ok);
  CHECK_FALSE(
      s.kkt.solve_coupled(nullptr, s.some_held(0), s.node_rhs, s.row_rhs, 1e-12, s.dx, s.dlambda, s.seconds));
}

TEST_CASE("the operator on dual multipliers is the Schur complement, weighed") {
  const auto system = test::value(test::random_system(4, {augmented_hard, augmented_coupled}));
  Solved s(system, Solver::automatic);
  REQUIRE(s.factor({}).status == FactorStatus::ok);
  const Eigen::Index n = s.system->free_unknowns(), m = s.system->rows();
  Kkt::Values values;
  const auto w = s.kkt.dual_weights(values);
  const Eigen::MatrixXd a = test::dense_saddle(s.assembly, kMassScale, {});
  const Eigen::MatrixXd g = a.bottomLeftCorner(m, n), c = -a.bottomRightCorner(m, m);
  const Eigen::VectorXd weight = Eigen::Map<const Eigen::VectorXd>(w.data(), m);
  CHECK(weight.minCoeff() > 0);
  const Eigen::MatrixXd k = a.topLeftCorner(n, n) + test::product(g.transpose() * weight.asDiagonal(), g);
  const Eigen::MatrixXd t = Eigen::MatrixXd::Identity(m, m) - weight.asDiagonal() * c;
  const Eigen::MatrixXd schur =
      test::product(t.transpose(), c + test::product(g, test::solve(k, test::product(g.transpose(), t))));
  const Eigen::VectorXd p = Eigen::Map<const Eigen::VectorXd>(s.row_rhs.data(), m);
  std::vector<double> q(s.row_rhs.size());
  REQUIRE(s.kkt.apply_dual(s.row_rhs, q, s.seconds));
  CHECK((Eigen::Map<const Eigen::VectorXd>(q.data(), m) - schur * p).cwiseAbs().maxCoeff() <
        1e-10 * (schur * p).cwiseAbs().maxCoeff());
  CHECK((schur - schur.transpose()).cwiseAbs().maxCoeff() < 1e-12 * schur.cwiseAbs().maxCoeff());
}
