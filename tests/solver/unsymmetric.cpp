// LU factors of matrices that are symmetric in their pattern alone.
#include <cmath>
#include <limits>

#include "catch.h"
#include "engine/solvers/foreign/mumps_solver.h"
#include "engine/solvers/front/lu_solver.h"
#include "solver/linear_support.h"
#include "support/dense.h"

using namespace isochor;

namespace {

struct Backend {
  const char* name;
  std::unique_ptr<LinearSolver> solver;
};
std::vector<Backend> backends() {
  std::vector<Backend> out;
  MumpsOptions options;
  options.unsymmetric = true;
  if (auto mumps = make_mumps_solver(options)) out.push_back({"mumps", std::move(mumps)});
  out.push_back({"eigen_lu", make_eigen_lu_solver()});
  return out;
}

// Lower triangle, then the transposed upper one with zeros on the diagonal.
struct Unsymmetric {
  test::Matrix lower;
  std::vector<double> values;
  Eigen::MatrixXd dense;
};

// A saddle point whose stiffness and columns of rows are disturbed, at places that are there already.
Unsymmetric disturbed(const test::Saddle& kind, double by, unsigned seed = 1) {
  Unsymmetric u{test::saddle(kind, seed), {}, {}};
  u.dense = u.lower.dense();
  std::mt19937 random(seed + 7);
  std::uniform_real_distribution<double> unit(-1, 1);
  u.values = u.lower.values;
  u.values.resize(2 * u.lower.values.size(), 0);
  const SymmetricPattern& p = u.lower.pattern;
  for (Index c = 0; c < p.size; ++c) {
    for (auto k = p.column_start[at(c)]; k < p.column_start[at(c) + 1]; ++k) {
      const Index r = p.row[static_cast<std::size_t>(k)];
      if (r == c) continue;
      u.dense(c, r) += by * unit(random);
      u.values[u.lower.values.size() + static_cast<std::size_t>(k)] = u.dense(c, r);
    }
  }
  return u;
}

}  // namespace

TEST_CASE("LU factors solve unsymmetric saddle points, hard rows included") {
  for (auto& [name, solver] : backends()) {
    for (const double compliance : {0.0, 0.1}) {
      for (const bool dense_row : {false, true}) {
        INFO(name << ", compliance " << compliance << (dense_row ? ", with a dense row" : ""));
        const Unsymmetric u =
            disturbed({.nodes = 40, .rows = 12, .dense_row = dense_row, .compliance = compliance}, 0.3);
        CHECK((u.dense - u.dense.transpose()).norm() > 0.5);
        REQUIRE(solver->analyze(u.lower.pattern).status == FactorStatus::ok);
        const FactorReport f = solver->factor(u.values);
        INFO(f.message);
        REQUIRE(f.status == FactorStatus::ok);
        CHECK(f.negative_pivots == -1);
        CHECK(f.factor_nonzeros > 0);
        const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(u.dense.rows(), -1, 2);
        std::vector<double> b(right.data(), right.data() + right.size()), x(b.size());
        const SolveReport s = solver->solve(b, x);
        CHECK(s.ok);
        CHECK(s.residual < 1e-13);
        const Eigen::VectorXd exact = test::solve(u.dense, right);
        CHECK((Eigen::Map<Eigen::VectorXd>(x.data(), exact.size()) - exact).norm() < 1e-9 * exact.norm());
      }
    }
  }
}

TEST_CASE("one analysis serves many unsymmetric matrices, to the same bits") {
  for (auto& [name, solver] : backends()) {
    INFO(name);
    Unsymmetric a = disturbed({.nodes = 30, .rows = 8}, 0.2), b = disturbed({.nodes = 30, .rows = 8}, 0.4);
    REQUIRE(solver->analyze(a.lower.pattern).status == FactorStatus::ok);
    std::vector<double> right(at(a.lower.pattern.size), 1.0), first(right.size()), other(right.size()),
        again(right.size());
    REQUIRE(solver->factor(a.values).status == FactorStatus::ok);
    REQUIRE(solver->solve(right, first).ok);
    REQUIRE(solver->factor(b.values).status == FactorStatus::ok);
    REQUIRE(solver->solve(right, other).ok);
    REQUIRE(solver->factor(a.values).status == FactorStatus::ok);
    REQUIRE(solver->solve(right, again).ok);
    CHECK(first == again);
    CHECK(first != other);
  }
}

TEST_CASE("unsymmetric matrices without factors are told apart") {
  for (auto& [name, solver] : backends()) {
    INFO(name);
    Unsymmetric u = disturbed({.nodes = 20, .rows = 5}, 0.2);
    REQUIRE(solver->analyze(u.lower.pattern).status == FactorStatus::ok);
    CHECK(solver->factor(u.lower.values).status == FactorStatus::failed);
    auto values = u.values;
    values.back() = std::numeric_limits<double>::quiet_NaN();
    values[values.size() / 2 + 1] = std::numeric_limits<double>::quiet_NaN();
    CHECK(solver->factor(values).status == FactorStatus::not_finite);
    // Row 4 of the matrix becomes zero.
    values = u.values;
    const SymmetricPattern& p = u.lower.pattern;
    for (Index c = 0; c < p.size; ++c) {
      for (auto k = static_cast<std::size_t>(p.column_start[at(c)]);
           k < static_cast<std::size_t>(p.column_start[at(c) + 1]); ++k) {
        if (p.row[k] == 4) values[k] = 0;
        if (c == 4) values[u.lower.values.size() + k] = 0;
      }
    }
    CHECK(solver->factor(values).status == FactorStatus::singular);
    // And the solver goes on with the next one.
    CHECK(solver->factor(u.values).status == FactorStatus::ok);
  }
}
