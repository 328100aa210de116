// The generalized minimal residual method on small dense systems.
#include "engine/solvers/gmres.h"

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "catch.h"

using namespace isochor;

namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

Eigen::Map<const Vector> view(std::span<const double> v) {
  return {v.data(), static_cast<Eigen::Index>(v.size())};
}
Eigen::Map<Vector> view(std::span<double> v) {
  return {v.data(), static_cast<Eigen::Index>(v.size())};
}

// Symmetric indefinite.
Matrix symmetric(Eigen::Index n) {
  Matrix a(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) a(i, j) = 1.0 / static_cast<double>(1 + i + j);
    a(i, i) += i % 3 == 0 ? -2 : 3;
  }
  return a;
}

// Unsymmetric, of the given rank.
Matrix change(Eigen::Index n, Eigen::Index rank) {
  Matrix u(n, rank), v(n, rank);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < rank; ++k) {
      u(i, k) = std::sin(static_cast<double>((3 + k) * i + 1));
      v(i, k) = std::cos(static_cast<double>((5 + k) * i));
    }
  }
  return u * v.transpose();
}

}  // namespace

TEST_CASE("a change of rank k takes k + 1 directions on the factors of the rest") {
  constexpr Eigen::Index n = 40;
  const Matrix a = symmetric(n);
  const Eigen::PartialPivLU<Matrix> factors(a);
  Vector b(n);
  for (Eigen::Index i = 0; i < n; ++i) b[i] = std::cos(static_cast<double>(i));
  for (const Eigen::Index rank : {0, 1, 3, 6}) {
    INFO("rank " << rank);
    const Matrix whole = a + (rank > 0 ? change(n, rank) : Matrix(Matrix::Zero(n, n)));
    Gmres gmres(n, 10);
    std::vector<double> x(n, 7);
    const int steps = gmres.solve(
        {b.data(), at(n)}, x, 1e-10,
        [&](std::span<const double> v, std::span<double> w) { view(w) = whole * view(v); },
        [&](std::span<double> v) {
          const Vector z = factors.solve(view(v));
          view(v) = z;
          return true;
        });
    CHECK(steps == static_cast<int>(rank) + 1);
    const double left = (b - whole * view(std::span<const double>(x))).norm();
    CHECK(left < 1e-9 * b.norm());
    // What it says is left is what is left.
    CHECK(std::abs(gmres.left() - left) < 1e-11 * b.norm());
    CHECK(gmres.start_norm() == Approx(b.norm()));
  }
}

TEST_CASE("the method says when its room does not do, and stops at what asked for nothing") {
  constexpr Eigen::Index n = 40;
  const Matrix whole = symmetric(n) + change(n, 6);
  Vector b = Vector::Ones(n);
  Gmres gmres(n, 3);
  std::vector<double> x(n, 7);
  const auto apply = [&](std::span<const double> v, std::span<double> w) { view(w) = whole * view(v); };
  const auto nothing = [](std::span<double>) { return true; };
  CHECK(gmres.solve({b.data(), at(n)}, x, 1e-10, apply, nothing) == 3);
  CHECK(gmres.left() > 1e-6 * b.norm());
  CHECK(gmres.left() == Approx((b - whole * view(std::span<const double>(x))).norm()).epsilon(1e-9));
  CHECK(gmres.solve({b.data(), at(n)}, x, 1e-10, apply, [](std::span<double>) { return false; }) == -1);
  b.setZero();
  CHECK(gmres.solve({b.data(), at(n)}, x, 1e-10, apply, nothing) == 0);
  CHECK(view(std::span<const double>(x)).norm() == 0);
}

TEST_CASE("directions that are made again lead where kept ones do, on one thread or several") {
  constexpr Eigen::Index n = 9000;
  // Tridiagonal and unsymmetric, by its diagonal; longer than a block of the sums.
  const auto apply = [](std::span<const double> v, std::span<double> w) {
    for (std::size_t i = 0; i < v.size(); ++i) {
      w[i] = (i % 3 == 0 ? -4 : 5) * v[i];
      if (i > 0) w[i] += v[i - 1];
      if (i + 1 < v.size()) w[i] -= 0.5 * v[i + 1];
    }
  };
  const auto precondition = [](std::span<double> v) {
    for (std::size_t i = 0; i < v.size(); ++i) v[i] /= i % 3 == 0 ? -4 : 5;
    return true;
  };
  std::vector<double> b(n), kept(n), again(n), threads(n), product(n);
  for (std::size_t i = 0; i < b.size(); ++i) b[i] = std::sin(static_cast<double>(i * i % 97));
  Gmres first(n, 40), second(n, 40, Gmres::Directions::made_again);
  const int steps = first.solve(b, kept, 1e-10, apply, precondition);
  REQUIRE(steps > 3);
  REQUIRE(steps < 40);
  CHECK(second.solve(b, again, 1e-10, apply, precondition) == steps);
  CHECK((view(std::span<const double>(kept)) - view(std::span<const double>(again))).norm() <
        1e-9 * view(std::span<const double>(kept)).norm());
  apply(again, product);
  CHECK((view(std::span<const double>(product)) - view(std::span<const double>(b))).norm() <
        2e-10 * view(std::span<const double>(b)).norm());
  const TbbParallel parallel(3);
  Gmres third(n, 40, Gmres::Directions::made_again);
  third.set_loop(RowLoop(&parallel));
  third.solve(b, threads, 1e-10, apply, precondition);
  CHECK(threads == again);
}
