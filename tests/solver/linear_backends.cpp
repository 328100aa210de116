// Every linear solver backend on the same matrices: solutions, inertia, and what it says where there is none.
#include <cmath>
#include <limits>
#include <thread>

#include "catch.h"
#include "solver/linear_support.h"
#include "support/dense.h"

namespace {

using namespace isochor;
using test::Matrix;
using test::Saddle;

struct Backend {
  Solver kind;
  const char* name;
};
constexpr Backend kBackends[] = {{Solver::mumps, "mumps"},
                                 {Solver::cholmod, "cholmod"},
                                 {Solver::eigen, "eigen"},
                                 {Solver::multifrontal, "multifrontal"},
                                 {Solver::automatic, "automatic"}};

template <class Body>
void for_each_backend(Body body) {
  for (const Backend& b : kBackends) {
    const auto solver = make_linear_solver(b.kind);
    if (!solver) continue;  // not part of this build
    INFO(b.name);
    body(*solver, b.kind);
  }
}

double error_of(const Eigen::VectorXd& exact, const std::vector<double>& x) {
  return (Eigen::Map<const Eigen::VectorXd>(x.data(), exact.size()) - exact).norm() / exact.norm();
}

int negative_eigenvalues(const Matrix& m) {
  return test::negative_eigenvalues(m.dense());
}

void check_solution(LinearSolver& solver, const Matrix& m) {
  REQUIRE(solver.analyze(m.pattern).status == FactorStatus::ok);
  const FactorReport f = solver.factor(m.values);
  INFO(f.message);
  REQUIRE(f.status == FactorStatus::ok);
  if (f.negative_pivots >= 0) CHECK(f.negative_pivots == negative_eigenvalues(m));
  const std::vector<double> b = test::random_vector(m.pattern.size);
  std::vector<double> x(b.size());
  const SolveReport s = solver.solve(b, x);
  CHECK(s.ok);
  CHECK(s.residual < 1e-13);
  const Eigen::VectorXd exact =
      test::solve(m.dense(), Eigen::Map<const Eigen::VectorXd>(b.data(), m.pattern.size));
  CHECK(error_of(exact, x) < 1e-9);
}

}  // namespace

TEST_CASE("backends solve saddle-point systems with hard and compliant rows") {
  for (const double compliance : {0.0, 1e-8, 0.3}) {
    INFO("compliance " << compliance);
    const Matrix m = test::saddle({60, 20, false, compliance, 0});
    for_each_backend([&](LinearSolver& solver, Solver) { check_solution(solver, m); });
  }
}

TEST_CASE("backends tell the inertia of an indefinite stiffness block") {
  for (int negative = 0; negative < 4; ++negative) {
    const Matrix m = test::saddle({60, 20, false, 0.1, negative});
    INFO(negative << " nodes turned negative");
    for_each_backend([&](LinearSolver& solver, Solver) { check_solution(solver, m); });
  }
}

TEST_CASE("backends take a row over everything") {
  const Matrix m = test::saddle({400, 100, true, 0, 0});
  for_each_backend([&](LinearSolver& solver, Solver) { check_solution(solver, m); });
}

TEST_CASE("backends factor again and again on one analysis") {
  const Matrix m = test::saddle({60, 20, true, 1e-3, 0});
  for_each_backend([&](LinearSolver& solver, Solver) {
    REQUIRE(solver.analyze(m.pattern).status == FactorStatus::ok);
    std::vector<double> values = m.values;
    const std::vector<double> b = test::random_vector(m.pattern.size);
    std::vector<double> x(b.size()), first(b.size());
    for (int k = 0; k < 3; ++k) {
      for (double& v : values) v *= 2;
      REQUIRE(solver.factor(values).status == FactorStatus::ok);
      REQUIRE(solver.solve(b, x).ok);
      if (k == 0) first = x;
    }
    for (std::size_t i = 0; i < x.size(); ++i) CHECK(4 * x[i] == Approx(first[i]).margin(1e-12));
  });
}

TEST_CASE("backends say that a matrix is singular") {
  // Two equal rows.
  Eigen::MatrixXd a = test::saddle({20, 5, false, 0, 0}).dense();
  const Eigen::Index n = a.rows();
  a.row(n - 1) = a.row(n - 2);
  a.col(n - 1) = a.col(n - 2);
  a.bottomRightCorner(2, 2).setZero();
  const Matrix m = test::sparse(a);
  // A whole zero block.
  Eigen::MatrixXd z = test::saddle({20, 0, false, 0, 0}).dense();
  z.row(4).setZero();
  z.col(4).setZero();
  const Matrix zero_row = test::sparse(z);
  Matrix zero = m;
  std::fill(zero.values.begin(), zero.values.end(), 0.0);
  for_each_backend([&](LinearSolver& solver, Solver) {
    for (const Matrix* s : {static_cast<const Matrix*>(&m), &zero_row, static_cast<const Matrix*>(&zero)}) {
      REQUIRE(solver.analyze(s->pattern).status == FactorStatus::ok);
      const FactorReport f = solver.factor(s->values);
      std::vector<double> b = test::random_vector(s->pattern.size), x(b.size());
      // Either the factorization says so, or the solution's residual does; never NaN, never a claim of
      // success.
      const SolveReport r = solver.solve(b, x);
      CHECK((f.status == FactorStatus::singular || !r.ok));
      for (const double v : x) CHECK(std::isfinite(v));
    }
    // And the solver still works.
    check_solution(solver, test::saddle({20, 5, false, 0.1, 0}));
  });
}

TEST_CASE("backends refuse what is not finite and what does not fit") {
  const Matrix m = test::saddle({20, 5, false, 0.1, 0});
  for_each_backend([&](LinearSolver& solver, Solver) {
    CHECK(solver.factor(m.values).status == FactorStatus::failed);  // not analyzed yet
    REQUIRE(solver.analyze(m.pattern).status == FactorStatus::ok);
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
      std::vector<double> values = m.values;
      values[7] = bad;
      const FactorReport f = solver.factor(values);
      CHECK(f.status == FactorStatus::not_finite);
      CHECK_FALSE(f.message.empty());
    }
    CHECK(solver.factor(std::span(m.values).subspan(1)).status == FactorStatus::failed);
    REQUIRE(solver.factor(m.values).status == FactorStatus::ok);
    std::vector<double> b = test::random_vector(m.pattern.size), x(b.size());
    b[3] = std::nan("");
    CHECK_FALSE(solver.solve(b, x).ok);
    for (const double v : x) CHECK(std::isfinite(v));
    b[3] = 1;
    CHECK(solver.solve(b, x).ok);
    std::vector<double> short_b(b.size() - 1);
    CHECK_FALSE(solver.solve(short_b, x).ok);

    SymmetricPattern broken = m.pattern;
    broken.row[5] = m.pattern.size + 3;
    const FactorReport f = solver.analyze(broken);
    CHECK(f.status == FactorStatus::failed);
    CHECK(f.message.find("column") != std::string::npos);
    broken = m.pattern;
    broken.group[0] = -1;
    CHECK(solver.analyze(broken).status == FactorStatus::failed);
  });
}

TEST_CASE("backends take matrices of size nothing and one") {
  for_each_backend([&](LinearSolver& solver, Solver) {
    SymmetricPattern empty;
    empty.column_start = {0};
    REQUIRE(solver.analyze(empty).status == FactorStatus::ok);
    const FactorReport f = solver.factor({});
    CHECK(f.status == FactorStatus::ok);
    CHECK(f.negative_pivots == 0);
    CHECK(solver.solve({}, {}).ok);
    for (const double a : {2.0, -2.0}) {
      const Matrix one = test::sparse(Eigen::MatrixXd::Constant(1, 1, a));
      REQUIRE(solver.analyze(one.pattern).status == FactorStatus::ok);
      REQUIRE(solver.factor(one.values).status == FactorStatus::ok);
      std::vector<double> b{3}, x{0};
      REQUIRE(solver.solve(b, x).ok);
      CHECK(x[0] == Approx(3 / a));
    }
  });
}

TEST_CASE("badly scaled rows are refined to full accuracy") {
  // A stiffness ratio of 1e8 across the chain.
  Eigen::MatrixXd a = test::saddle({60, 20, false, 1e-3, 0}).dense();
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    const double s = std::pow(10.0, 4.0 * std::sin(static_cast<double>(i)));
    a.row(i) *= s;
    a.col(i) *= s;
  }
  const Matrix m = test::sparse(a);
  for_each_backend([&](LinearSolver& solver, Solver) {
    REQUIRE(solver.analyze(m.pattern).status == FactorStatus::ok);
    if (solver.factor(m.values).status != FactorStatus::ok) return;  // refusing is honest
    std::vector<double> b = test::random_vector(m.pattern.size), x(b.size());
    const SolveReport s = solver.solve(b, x);
    if (s.ok) CHECK(s.residual <= 1e-10);
  });
}

TEST_CASE("solvers work side by side in several threads, bit for bit") {
  const Matrix m = test::saddle({200, 60, true, 1e-3, 0});
  for_each_backend([&](LinearSolver& solver, Solver kind) {
    const std::vector<double> b = test::random_vector(m.pattern.size);
    std::vector<double> expected(b.size());
    REQUIRE(solver.analyze(m.pattern).status == FactorStatus::ok);
    REQUIRE(solver.factor(m.values).status == FactorStatus::ok);
    REQUIRE(solver.solve(b, expected).ok);
    std::vector<std::vector<double>> results(4, std::vector<double>(b.size()));
    std::vector<std::thread> threads;
    for (auto& x : results) {
      threads.emplace_back([&] {
        const auto own = make_linear_solver(kind);
        for (int k = 0; k < 5; ++k) {
          if (own->analyze(m.pattern).status == FactorStatus::ok &&
              own->factor(m.values).status == FactorStatus::ok) {
            own->solve(b, x);
          }
        }
      });
    }
    for (auto& t : threads) t.join();
    for (const auto& x : results) CHECK(x == expected);
  });
}

TEST_CASE("the process has a fixed number of BLAS threads, whatever the machine") {
  make_linear_solver(Solver::automatic);
  const int before = blas_threads();
  if (before == 0) return;  // a BLAS that cannot be told
  CHECK_FALSE(set_blas_threads(0));
  CHECK(set_blas_threads(1));
  CHECK(blas_threads() == 1);
  make_linear_solver(Solver::automatic);
  CHECK(blas_threads() == 1);  // a choice made is kept
  CHECK(set_blas_threads(before));
}
