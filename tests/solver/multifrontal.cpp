// Our own multifrontal factors: the tree against a dense elimination, precision that is climbed as matrices
// need it, the same bits at any number of threads.
#include <cmath>

#include "catch.h"
#include "engine/base/parallel.h"
#include "engine/solvers/foreign/eigen_solver.h"
#include "engine/solvers/foreign/mumps_solver.h"
#include "engine/solvers/front/multifrontal_solver.h"
#include "solver/linear_support.h"
#include "support/dense.h"

namespace {

using namespace isochor;
using test::Matrix;
using Rung = MultifrontalSolver::Rung;

std::unique_ptr<LinearSolver> pivoting() {
  auto solver = make_mumps_solver();
  return solver ? std::move(solver) : make_eigen_solver();
}

Index negative_eigenvalues(const Matrix& m) {
  return test::negative_eigenvalues(m.dense());
}

// Entries of L and multiplications, by eliminating a dense pattern.
struct Fill {
  std::int64_t entries = 0;
  double operations = 0;
};

Fill dense_fill(const Matrix& m, const Ordering& ordering) {
  const Index n = m.pattern.size;
  std::vector<std::vector<bool>> a(at(n), std::vector<bool>(at(n), false));
  for (Index c = 0; c < n; ++c) {
    for (auto k = m.pattern.column_start[at(c)]; k < m.pattern.column_start[at(c) + 1]; ++k) {
      const Index i = ordering.position[at(m.pattern.row[static_cast<std::size_t>(k)])];
      const Index j = ordering.position[at(c)];
      a[at(std::max(i, j))][at(std::min(i, j))] = true;
    }
  }
  Fill fill;
  for (Index j = 0; j < n; ++j) {
    std::vector<Index> below;
    for (Index i = j + 1; i < n; ++i) {
      if (a[at(i)][at(j)]) below.push_back(i);
    }
    for (const Index i : below) {
      for (const Index k : below) {
        if (k <= i) a[at(i)][at(k)] = true;
      }
    }
    const double count = static_cast<double>(below.size());
    fill.entries += 1 + static_cast<std::int64_t>(below.size());
    fill.operations += 0.5 * count * (count + 3);
  }
  return fill;
}

// The matrix with the eigenvalue that is nearest to zero moved to `value`.
Matrix with_eigenvalue(const Matrix& m, double value) {
  const test::Spectrum all = test::spectrum(m.dense());
  Eigen::Index nearest = 0;
  all.values.cwiseAbs().minCoeff(&nearest);
  const Eigen::VectorXd v = all.vectors.col(nearest);
  const Eigen::MatrixXd a = m.dense() + (value - all.values[nearest]) * v * v.transpose();
  Matrix out = test::sparse(0.5 * (a + a.transpose()));
  out.pattern.multiplier = m.pattern.multiplier;
  return out;
}

// Factors of another matrix: diag(1, wrong) in place of diag(1, right), until it is strengthened.
class Wrong final : public DirectSolver {
 public:
  Wrong(double wrong, double right) : wrong_(wrong), right_(right) {}
  std::string_view name() const override { return "wrong"; }
  int strengthened = 0;

 protected:
  FactorReport analyze_pattern() override { return {}; }
  FactorReport factor_values() override { return {}; }
  bool apply_inverse(std::span<double> x) override {
    x[1] /= strengthened > 0 ? right_ : wrong_;
    return true;
  }
  bool doubtful() const override { return strengthened == 0 && residual_ratio() > 0.25; }
  bool strengthen(SolveReport& report) override {
    report.inertia_changed = wrong_ * right_ < 0;
    return ++strengthened == 1;
  }

 private:
  double wrong_, right_;
};

}  // namespace

TEST_CASE("a solution that grows without converging is not trusted") {
  const std::vector<double> b{1, 1};
  std::vector<double> x(2);
  const auto solve = [&](double wrong, double right, int& strengthened) {
    Eigen::MatrixXd a = Eigen::MatrixXd::Identity(2, 2);
    a(1, 1) = right;
    const Matrix m = test::sparse(a);
    Wrong solver(wrong, right);
    REQUIRE(solver.analyze(m.pattern).status == FactorStatus::ok);
    REQUIRE(solver.factor(m.values).status == FactorStatus::ok);
    const SolveReport s = solver.solve(b, x);
    strengthened = solver.strengthened;
    return s;
  };
  int strengthened = 0;
  CHECK(solve(1e-10, 1.01e-10, strengthened).ok);  // refinement contracts by a hundred
  CHECK(strengthened == 0);
  // The relative residual is below 1e-10, because the solution is huge.
  CHECK(solve(1e-10, 1e-13, strengthened).ok);
  CHECK(strengthened == 1);
  CHECK(x[1] == Approx(1e13));
  // An eigenvalue of the other sign: solved, but with another inertia than was told.
  const SolveReport s = solve(1e-10, -1e-13, strengthened);
  CHECK(strengthened == 1);
  CHECK(s.inertia_changed);
  CHECK_FALSE(s.ok);
}

TEST_CASE("the tree counts what a dense elimination fills") {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const Matrix m = test::saddle({40, 13, seed == 2, 0.1, 0}, seed);
    for (const auto method : {OrderingMethod::as_given, OrderingMethod::amd, OrderingMethod::best}) {
      const Ordering ordering = order_unknowns(m.pattern, method);
      const Fill fill = dense_fill(m, ordering);
      const FrontTree tree = front_tree(m.pattern, ordering);
      CHECK(tree.factor_nonzeros == fill.entries);
      CHECK(tree.operations == Approx(fill.operations));
      CHECK(operations_of(m.pattern, ordering) == Approx(fill.operations));
      CHECK(tree.panel_start.back() >= tree.factor_nonzeros - tree.size);
      for (Index f = 0; f < tree.fronts(); ++f) {
        REQUIRE((tree.parent[at(f)] == -1 || tree.parent[at(f)] > f));
        REQUIRE((tree.updates(f) == 0) == (tree.parent[at(f)] == -1));
      }
    }
  }
}

namespace {

// With entries more in the lower triangle, at most `reach` below the diagonal.
SymmetricPattern with_entries(SymmetricPattern p, Index count, Index reach) {
  std::vector<std::vector<Index>> column(at(p.size));
  for (Index c = 0; c < p.size; ++c)
    column[at(c)].assign(p.row.begin() + p.column_start[at(c)], p.row.begin() + p.column_start[at(c) + 1]);
  std::uint32_t state = 7;
  const auto draw = [&](Index end) {
    state = state * 1664525u + 1013904223u;
    return static_cast<Index>((state >> 8) % static_cast<std::uint32_t>(end));
  };
  for (Index k = 0; k < count; ++k) {
    const Index c = draw(p.size - reach);
    column[at(c)].push_back(c + draw(reach));
  }
  p.row.clear();
  p.column_start = {0};
  for (auto& rows : column) {
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    p.row.insert(p.row.end(), rows.begin(), rows.end());
    p.column_start.push_back(static_cast<std::int64_t>(p.row.size()));
  }
  return p;
}

}  // namespace

TEST_CASE("a pattern that differs little takes the sequence of its base, one that differs much has its own") {
  SymmetricPattern pattern = test::saddle({600, 200, false, 0, 0}).pattern;
  const Ordering own = best_ordering(pattern);
  const auto with_base = [&](Index count, Index reach) {
    SymmetricPattern changed = with_entries(pattern, count, reach);
    changed.base = std::make_shared<OrderingBase>();
    changed.base->pattern = pattern;
    return changed;
  };
  const SymmetricPattern little = with_base(10, 30), much = with_base(2000, 1800);
  REQUIRE(little.nonzeros() > pattern.nonzeros());
  CHECK((best_ordering(little).position == own.position));
  // What was asked before does not matter.
  CHECK((best_ordering(little).position == own.position));
  const Ordering other = best_ordering(much);
  CHECK((other.position != own.position));
  CHECK(operations_of(much, other) < operations_of(much, own));
  SymmetricPattern strange = with_base(10, 30);
  strange.base->pattern = test::saddle({90, 10, false, 0, 0}).pattern;
  CHECK((best_ordering(strange).position == best_ordering(with_entries(pattern, 10, 30)).position));
}

TEST_CASE("factors take another tree in the memory of the last") {
  FrontFactor<double> factor;
  std::vector<FrontTree> trees;
  trees.reserve(3);
  for (const Index size : {200, 60, 240}) {
    const Matrix m = test::saddle({size, size / 3, false, 1e-3, 2});
    trees.push_back(front_tree(m.pattern, order_unknowns(m.pattern)));
    factor.set_tree(trees.back());
    REQUIRE(factor.factor(RowLoop(), m.values, 1e-13));
    std::vector<double> x = test::random_vector(m.pattern.size);
    const Eigen::VectorXd exact =
        test::solve(m.dense(), Eigen::Map<const Eigen::VectorXd>(x.data(), m.pattern.size));
    factor.solve(x);
    CHECK((Eigen::Map<Eigen::VectorXd>(x.data(), exact.size()) - exact).norm() < 1e-9 * exact.norm());
  }
}

TEST_CASE("fronts eliminate and solve in both precisions") {
  for (const bool dense_row : {false, true}) {
    const Matrix m = test::saddle({120, 36, dense_row, 1e-3, 2});
    const FrontTree tree = front_tree(m.pattern, order_unknowns(m.pattern));
    const std::vector<double> b = test::random_vector(m.pattern.size);
    const Eigen::VectorXd exact =
        test::solve(m.dense(), Eigen::Map<const Eigen::VectorXd>(b.data(), m.pattern.size));
    FrontFactor<double> full;
    full.set_tree(tree);
    REQUIRE(full.factor(RowLoop(), m.values, 1e-13));
    std::vector<double> x = b;
    full.solve(x);
    CHECK((Eigen::Map<Eigen::VectorXd>(x.data(), exact.size()) - exact).norm() < 1e-9 * exact.norm());
    CHECK(full.negative_pivots() == negative_eigenvalues(m));
    FrontFactor<float> single;
    single.set_tree(tree);
    REQUIRE(single.factor(RowLoop(), m.values, 1e-6f));
    std::vector<float> y(b.begin(), b.end());
    single.solve(y);
    const double error = (Eigen::Map<Eigen::VectorXf>(y.data(), exact.size()).cast<double>() - exact).norm();
    CHECK(error < 1e-2 * exact.norm());
    CHECK(error > 1e-9 * exact.norm());  // it is single precision
  }
}

TEST_CASE("fronts have the same bits at any number of threads") {
  const Matrix m = test::saddle({400, 120, true, 1e-3, 0});
  const std::vector<double> b = test::random_vector(m.pattern.size);
  std::vector<double> expected(b.size());
  for (const int threads : {1, 2, 4, 8}) {
    const TbbParallel parallel(threads);
    const auto solver = make_multifrontal_solver(pivoting(), {.single_from = 0});
    solver->set_parallel(parallel);
    REQUIRE(solver->analyze(m.pattern).status == FactorStatus::ok);
    std::vector<double> x(b.size());
    for (int k = 0; k < 3; ++k) {
      REQUIRE(solver->factor(m.values).status == FactorStatus::ok);
      REQUIRE(solver->solve(b, x).ok);
    }
    if (threads == 1) expected = x;
    CHECK(x == expected);
  }
}

TEST_CASE("a solution that need not be exact is refined only until it is good enough") {
  const Matrix m = test::saddle({400, 120, true, 1e-3, 0});
  const std::vector<double> b = test::random_vector(m.pattern.size);
  const auto solver = make_multifrontal_solver(pivoting(), {.single_from = 0});
  REQUIRE(solver->analyze(m.pattern).status == FactorStatus::ok);
  REQUIRE(solver->factor(m.values).status == FactorStatus::ok);
  std::vector<double> x(b.size());
  const Eigen::Map<const Eigen::VectorXd> right(b.data(), m.pattern.size);
  const auto solve = [&](double tolerance) {
    const SolveReport s = solver->solve_to(tolerance, b, x);
    CHECK(s.ok);
    const Eigen::Map<const Eigen::VectorXd> solution(x.data(), right.size());
    const double left = (right - m.dense() * solution).lpNorm<Eigen::Infinity>();
    CHECK(left <= std::max(tolerance, 1e-10) * right.lpNorm<Eigen::Infinity>());
    return s.refinements;
  };
  // Whether the first refinement contracts is what the inertia is believed for.
  CHECK(solve(1e-1) == 1);
  const int exact = solve(0), rough = solve(1e-1), finer = solve(1e-8);
  CHECK(rough == 0);
  CHECK(exact >= finer);
  CHECK(finer > rough);
}

// Whatever the precision: either factor() tells the inertia, or the solve takes it back.
TEST_CASE("an eigenvalue next to zero is told by its sign") {
  const Matrix base = test::saddle({50, 15, false, 0.1, 0});
  int climbed = 0;
  for (double size = 1e-3; size > 1e-10; size /= 4) {
    for (const double sign : {1.0, -1.0}) {
      const Matrix m = with_eigenvalue(base, sign * size);
      INFO("eigenvalue " << sign * size);
      MultifrontalSolver solver(pivoting(), {.single_from = 0});
      REQUIRE(solver.analyze(m.pattern).status == FactorStatus::ok);
      FactorReport f = solver.factor(m.values);
      REQUIRE(f.status == FactorStatus::ok);
      const std::vector<double> b = test::random_vector(m.pattern.size);
      std::vector<double> x(b.size());
      SolveReport s = solver.solve(b, x);
      if (s.inertia_changed) {
        CHECK_FALSE(s.ok);
        f = solver.factor(m.values);
        s = solver.solve(b, x);
      }
      CHECK(s.ok);
      CHECK(s.residual <= 1e-10);
      CHECK(f.negative_pivots == negative_eigenvalues(m));
      if (solver.rung() != Rung::single) ++climbed;
      if (size > 1e-4) CHECK(solver.rung() == Rung::single);
      if (size < 1e-9) CHECK(solver.rung() != Rung::single);
    }
  }
  CHECK(climbed > 4);
}

TEST_CASE("what was learned from a matrix is forgotten with the next saddle point") {
  const Matrix easy = test::saddle({50, 15, false, 0.1, 0});
  const Matrix hard = with_eigenvalue(easy, 1e-9);
  Matrix same_pattern = hard;
  const Eigen::MatrixXd values = easy.dense();
  for (Index c = 0; c < hard.pattern.size; ++c) {
    for (auto k = hard.pattern.column_start[at(c)]; k < hard.pattern.column_start[at(c) + 1]; ++k)
      same_pattern.values[static_cast<std::size_t>(k)] =
          values(hard.pattern.row[static_cast<std::size_t>(k)], c);
  }
  const std::vector<double> b = test::random_vector(easy.pattern.size);
  std::vector<double> fresh(b.size()), x(b.size());
  MultifrontalSolver solver(pivoting(), {.single_from = 0});
  const auto solve = [&](const Matrix& m, std::vector<double>& to) {
    REQUIRE(solver.factor(m.values).status == FactorStatus::ok);
    REQUIRE_FALSE(solver.solve(b, to).inertia_changed);
  };
  REQUIRE(solver.analyze(hard.pattern).status == FactorStatus::ok);
  solver.begin_solve();
  solve(same_pattern, fresh);
  CHECK(solver.rung() == Rung::single);
  solve(hard, x);
  CHECK(solver.rung() == Rung::full);
  solve(same_pattern, x);
  CHECK(solver.rung() == Rung::full);  // within one saddle point matrices are alike
  solver.begin_solve();
  solve(same_pattern, x);
  CHECK(solver.rung() == Rung::single);
  CHECK(x == fresh);
  CHECK(solver.reason() == "2 factorizations in single precision, 2 in double precision");
}

TEST_CASE("small systems start with double precision") {
  const Matrix m = test::saddle({50, 15, false, 0.1, 0});
  MultifrontalSolver solver(pivoting(), {});
  REQUIRE(solver.analyze(m.pattern).status == FactorStatus::ok);
  CHECK(solver.tree().operations < 1e8);
  REQUIRE(solver.factor(m.values).status == FactorStatus::ok);
  CHECK(solver.rung() == Rung::full);
}

TEST_CASE("pivots that vanish are left to a backend that pivots") {
  // A hard row comes first: no groups and no multipliers tell the ordering to wait with it.
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(4, 4);
  a(0, 1) = a(1, 0) = 1;
  a(1, 2) = a(2, 1) = 0.5;
  a(2, 2) = 2;
  a(3, 3) = 1;
  const Matrix m = test::sparse(a);
  MultifrontalSolver solver(pivoting(), {.single_from = 0, .ordering = OrderingMethod::as_given});
  REQUIRE(solver.analyze(m.pattern).status == FactorStatus::ok);
  const FactorReport f = solver.factor(m.values);
  REQUIRE(f.status == FactorStatus::ok);
  CHECK(f.negative_pivots == 1);
  CHECK(solver.rung() == Rung::pivoting);
  std::vector<double> b{1, 2, 3, 4}, x(4);
  REQUIRE(solver.solve(b, x).ok);
  for (Index i = 0; i < 4; ++i) {
    double sum = 0;
    for (Index j = 0; j < 4; ++j) sum += a(i, j) * x[at(j)];
    CHECK(sum == Approx(b[at(i)]).margin(1e-12));
  }
  CHECK(solver.reason().find("pivoted by") != std::string::npos);

  MultifrontalSolver alone(nullptr, {.single_from = 0, .ordering = OrderingMethod::as_given});
  REQUIRE(alone.analyze(m.pattern).status == FactorStatus::ok);
  const FactorReport refused = alone.factor(m.values);
  CHECK(refused.status == FactorStatus::singular);
  CHECK(refused.message.find("pivoting") != std::string::npos);
}
