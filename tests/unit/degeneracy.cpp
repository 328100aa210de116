// How energies behave where an element is crushed to a plane, a line or a point, or mirrored: Smith, de Goes
// & Kim 2018, section 3.3. And the baselines without an energy.
#include <Eigen/Eigenvalues>

#include "catch.h"
#include "engine/elements/material_model.h"
#include "isochor/materials.h"
#include "materials/stress_baselines.h"
#include "support/gradients.h"

using namespace isochor;
using test::Mat;

namespace {

struct Point {
  double psi;
  Mat P;
  Eigen::Matrix<double, 9, 1> eigenvalues;
};

Point at_point(const Material& material, const Mat& F) {
  PointBatch b;
  for (int l = 0; l < kLanes; ++l) {
    for (int i = 0; i < 9; ++i) b.F[i][l] = F(i / 3, i % 3);
    b.element[l] = 0;
  }
  ResponseBatch r;
  material.evaluate(Want::hessian, b, r);
  Eigen::Matrix<double, 9, 9> A;
  Point p;
  p.psi = r.psi[0];
  for (int i = 0, k = 0; i < 9; ++i) {
    p.P(i / 3, i % 3) = r.P[i][0];
    for (int j = 0; j <= i; ++j, ++k) A(i, j) = A(j, i) = r.A[k][0];
  }
  p.eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>>(A).eigenvalues();
  return p;
}

Mat diagonal(double a, double b, double c) {
  return Eigen::Vector3d(a, b, c).asDiagonal();
}

ElasticConstants constants(double poisson) {
  ElasticConstants c;
  c.young = 3;
  c.poisson = poisson;
  return c;
}

std::shared_ptr<const Material> complete(const Result<MaterialPtr>& model) {
  return model.value()->complete().value();
}

struct Named {
  const char* name;
  std::shared_ptr<const Material> material;
};

// The energies that claim to live through inversion and to come back from it.
std::vector<Named> inversion_safe(double poisson) {
  const double mu = 3 / (2 * (1 + poisson));
  return {{"stable_neo_hookean", complete(stable_neo_hookean(constants(poisson)))},
          {"stable_neo_hookean_barrier", complete(stable_neo_hookean_barrier(constants(poisson)))},
          {"mooney_rivlin", complete(mooney_rivlin({0.4 * mu, 0.1 * mu, poisson}))},
          {"fung", complete(fung({0.6 * mu, 0.2, 2 * mu, poisson}))},
          {"arruda_boyce", complete(arruda_boyce({mu, 0.1, 0.01, poisson}))}};
}

}  // namespace

TEST_CASE("crushed to a plane or mirrored, force pushes back along the normal") {
  for (const double nu : {0.3, 0.45, 0.49}) {
    for (const auto& [name, material] : inversion_safe(nu)) {
      for (const double thickness : {0.0, -1e-6, -0.3, -1.0}) {
        INFO(name << ", nu = " << nu << ", thickness " << thickness);
        const Point p = at_point(*material, diagonal(1, 1, thickness));
        // -P is the force along the normal: the energy falls toward the rest side all the way.
        CHECK(p.P(2, 2) < -0.1);
        CHECK(p.psi > at_point(*material, diagonal(1, 1, thickness + 0.1)).psi);
      }
    }
  }
}

TEST_CASE("crushed to a line, forces across vanish and some direction is unstable") {
  for (const double nu : {0.3, 0.45, 0.49}) {
    for (const auto& [name, material] : inversion_safe(nu)) {
      INFO(name << ", nu = " << nu);
      const Point p = at_point(*material, diagonal(1, 0, 0));
      CHECK(p.P.bottomRows(2).cwiseAbs().maxCoeff() == 0);
      CHECK(p.eigenvalues[0] < -0.1);
    }
  }
}

TEST_CASE("crushed to a point, eq. 13 is stable there and the barrier of eq. 14 makes it neutral") {
  for (const double nu : {0.3, 0.45, 0.49}) {
    const Point plain = at_point(*complete(stable_neo_hookean(constants(nu))), diagonal(0, 0, 0));
    CHECK(plain.P.norm() == 0);
    CHECK(plain.eigenvalues[0] > 0.5);
    const auto barrier = complete(stable_neo_hookean_barrier(constants(nu)));
    const Point semi = at_point(*barrier, diagonal(0, 0, 0));
    CHECK(semi.P.norm() == 0);
    CHECK(semi.eigenvalues.cwiseAbs().maxCoeff() < 1e-15);
    // Semi-definite only: growing in all directions at once gains energy at once.
    CHECK(at_point(*barrier, diagonal(0.2, 0.2, 0.2)).psi < semi.psi);
  }
}

TEST_CASE(
    "the energy of every inversion-safe material has its minimum at rest, along the way through inversion") {
  for (const auto& [name, material] : inversion_safe(0.49)) {
    INFO(name);
    CHECK(at_point(*material, Mat::Identity()).P.norm() < 1e-15);
    double before = at_point(*material, diagonal(1, 1, -2)).psi;
    for (double s = -1.95; s <= 1; s += 0.05) {
      const double here = at_point(*material, diagonal(1, 1, s)).psi;
      CHECK(here < before);
      before = here;
    }
  }
}

TEST_CASE("what SNH holds against the older energies is there to see") {
  const auto c = constants(0.45);
  // StVK: without force at full collapse, and weaker the further it is pressed.
  const auto soft = complete(stvk(c));
  CHECK(at_point(*soft, diagonal(1, 1, 0)).P(2, 2) == 0);
  CHECK(std::abs(at_point(*soft, diagonal(1, 1, 0.2)).P(2, 2)) <
        std::abs(at_point(*soft, diagonal(1, 1, 0.6)).P(2, 2)));
  // With resistance the cube pushes back at collapse.
  CHECK(at_point(*complete(stvk_resistant(c, 1e3)), diagonal(1, 1, 0)).P(2, 2) < -0.1);
  // Corotated: finite and pushing back when mirrored; the fixed form meets its volume term as a zero of g.
  for (const auto& m : {complete(corotated(c)), complete(fixed_corotated(c))}) {
    CHECK(at_point(*m, diagonal(1, 1, -0.5)).P(2, 2) < -0.1);
  }
  CHECK(std::isinf(at_point(*complete(neo_hookean(c)), diagonal(1, 1, 0)).psi));
  // The continued isochoric energy is finite and smooth through J = 0.
  const auto extended = complete(isochoric_extended(c));
  CHECK(std::isfinite(at_point(*extended, diagonal(1, 1, -0.5)).psi));
  CHECK(at_point(*extended, diagonal(1, 1, 0)).P(2, 2) < -0.1);
}

TEST_CASE("baselines without an energy say what their names say") {
  const double mu = 1.3, lambda = 4, threshold = 0.2;
  ElasticConstants c;
  c.mu = mu;
  c.lambda = lambda;
  const auto neo = complete(neo_hookean(c)), isochoric = isochoric_neo_hookean(c).value()->distortional();
  for (const auto& [name, F] : test::all_gradients()) {
    if (F.cwiseAbs().maxCoeff() > 1e3) continue;
    INFO(name);
    Lanes f[9], P[9];
    for (int i = 0; i < 9; ++i) f[i] = broadcast(F(i / 3, i % 3));
    filtered_neo_hookean_stress(mu, lambda, threshold, f, P);
    Mat filtered;
    for (int i = 0; i < 9; ++i) filtered(i / 3, i % 3) = P[i][0];
    CHECK(filtered.allFinite());
    if (test::svd_of(F).sigma[2] > threshold) {
      const Point p = at_point(*neo, F);
      CHECK((filtered - p.P).norm() < 1e-12 * (1 + p.P.norm()));
    }
    if (F.determinant() > 1e-3) {
      // The isochoric stress without its part along g, which is a pressure.
      simplified_isochoric_stress(mu, f, P);
      const Point p = at_point(*isochoric, F);
      Mat simplified;
      for (int i = 0; i < 9; ++i) simplified(i / 3, i % 3) = P[i][0];
      const Mat pressure = (p.P - simplified) * F.transpose();
      CHECK((pressure - pressure.trace() / 3 * Mat::Identity()).norm() < 1e-12 * (1 + p.P.norm() * F.norm()));
    }
  }
  // No energy: the tangent is not symmetric.
  const auto slope = [&](int in, int out) {
    Lanes f[9], P[9];
    const double h = 1e-6, base[9] = {1.2, 0.3, 0, -0.1, 0.9, 0.2, 0, 0.1, 0.7};
    double value[2];
    for (const int side : {0, 1}) {
      for (int i = 0; i < 9; ++i) f[i] = broadcast(base[i] + (i == in ? (side ? h : -h) : 0));
      simplified_isochoric_stress(mu, f, P);
      value[side] = P[out][0];
    }
    return (value[1] - value[0]) / (2 * h);
  };
  CHECK(std::abs(slope(0, 4) - slope(4, 0)) > 0.01);
}
