// Hessians of materials in closed form, exact and made definite, against a dense eigen-solver.
#include <Eigen/Eigenvalues>

#include "catch.h"
#include "contract/registry.h"
#include "engine/elements/solid_pool.h"
#include "support/gradients.h"

using namespace isochor;
using test::Mat;

namespace {

using Mat9 = Eigen::Matrix<double, 9, 9>;

Mat9 dense(const double (&A)[45][kLanes]) {
  Mat9 out;
  for (int i = 0, k = 0; i < 9; ++i) {
    for (int j = 0; j <= i; ++j, ++k) out(i, j) = out(j, i) = A[k][0];
  }
  return out;
}

PointBatch batch_of(const Mat& F) {
  PointBatch b;
  for (int l = 0; l < kLanes; ++l) {
    for (int i = 0; i < 9; ++i) b.F[i][l] = F(i / 3, i % 3);
    b.element[l] = 0;
  }
  return b;
}

// d2J/dF2, entry by entry from permutations.
Mat9 volume_hessian(const Mat& F) {
  const auto eps = [](int i, int j, int k) { return (i - j) * (j - k) * (k - i) / 2.0; };
  Mat9 H = Mat9::Zero();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) {
        for (int l = 0; l < 3; ++l) {
          for (int m = 0; m < 3; ++m) {
            for (int n = 0; n < 3; ++n) H(3 * i + k, 3 * j + l) += eps(i, j, m) * eps(k, l, n) * F(m, n);
          }
        }
      }
    }
  }
  return H;
}

Eigen::Matrix<double, 9, 1> cofactor(const Mat& F) {
  const Mat9 H = volume_hessian(F);
  Eigen::Matrix<double, 9, 1> f;
  for (int i = 0; i < 9; ++i) f[i] = F(i / 3, i % 3);
  return 0.5 * H * f;  // H is linear and J cubic in F
}

// Of the material and a volume strain with given first and second derivative times multiplier, together.
Mat9 closed_form(const Material& material, const Mat& F, double first, double second, Definiteness policy) {
  const PointBatch b = batch_of(F);
  Lanes f[9], A[45];
  for (int i = 0; i < 9; ++i) f[i] = load(b.F[i]);
  Svd3 svd;
  svd3(f, svd);
  Spectrum spectrum;
  material.spectrum(b, svd, spectrum);
  add_volume(svd, broadcast(second), broadcast(first), spectrum);
  make_definite(policy, spectrum);
  assemble(svd, spectrum, A);
  ResponseBatch r;
  for (int i = 0; i < 45; ++i) store(A[i], r.A[i]);
  material.add_anisotropic(policy, b, r);
  return dense(r.A);
}

// Where a material has a second derivative that numbers can hold.
bool comparable(const test::MaterialCase& c, const Mat& F, const Mat9& exact) {
  const double J = F.determinant();
  if (!c.inverted && J < 1e-3) return false;
  return exact.allFinite() && exact.cwiseAbs().maxCoeff() < 1e8 * c.scale && F.cwiseAbs().maxCoeff() < 1e3;
}

Mat9 exact_hessian(const Material& material, const Mat& F, bool& has_value) {
  ResponseBatch r;
  material.evaluate(Want::hessian, batch_of(F), r);
  has_value = std::isfinite(r.psi[0]);
  return dense(r.A);
}

}  // namespace

TEST_CASE("closed-form Hessians are the exact ones, whatever the deformation") {
  for (const auto& c : test::material_cases()) {
    int compared = 0;
    for (const auto& [name, F] : test::all_gradients()) {
      INFO(c.name << ", " << name);
      bool has_value = false;
      const Mat9 exact = exact_hessian(*c.material, F, has_value);
      if (!has_value || !comparable(c, F, exact)) continue;
      ++compared;
      const Mat9 ours = closed_form(*c.material, F, 0, 0, Definiteness::exact);
      CHECK((ours - exact).cwiseAbs().maxCoeff() < 1e-12 * std::max(c.scale, exact.cwiseAbs().maxCoeff()));
    }
    INFO(c.name);
    CHECK(compared > 15);
  }
}

TEST_CASE("material and volume row together are made definite as the dense eigen-solver does it") {
  for (const auto& c : test::material_cases()) {
    if (!c.isotropic) continue;
    int indefinite = 0;
    for (const auto& [name, F] : test::all_gradients()) {
      bool has_value = false;
      const Mat9 material = exact_hessian(*c.material, F, has_value);
      if (!has_value || !comparable(c, F, material)) continue;
      for (const double multiplier : {-2.0, 0.0, 0.7, 5.0}) {
        for (const double bend : {0.0, -0.8}) {
          INFO(c.name << ", " << name << ", multiplier " << multiplier << ", second derivative " << bend);
          const auto g = cofactor(F);
          const Mat9 joint = material + multiplier * (volume_hessian(F) + bend * g * g.transpose());
          const Eigen::SelfAdjointEigenSolver<Mat9> eigen(joint);
          const auto rebuilt = [&](auto change) -> Mat9 {
            return eigen.eigenvectors() * eigen.eigenvalues().unaryExpr(change).asDiagonal() *
                   eigen.eigenvectors().transpose();
          };
          const double size = std::max(c.scale, joint.cwiseAbs().maxCoeff());
          indefinite += eigen.eigenvalues()[0] < -1e-6 * size;
          const auto differs = [&](Definiteness policy, const Mat9& from) {
            const Mat9 ours = closed_form(*c.material, F, multiplier, multiplier * bend, policy);
            return (ours - from).cwiseAbs().maxCoeff() / size;
          };
          CHECK(differs(Definiteness::exact, joint) < 1e-12);
          CHECK(differs(Definiteness::projected, rebuilt([](double v) { return std::max(v, 0.0); })) < 1e-12);
          CHECK(differs(Definiteness::absolute, rebuilt([](double v) { return std::abs(v); })) < 1e-12);
        }
      }
    }
    INFO(c.name);
    CHECK(indefinite > 10);
  }
}

TEST_CASE("definite Hessians of every material have no negative eigenvalue") {
  for (const auto& c : test::material_cases()) {
    for (const auto& [name, F] : test::all_gradients()) {
      if (F.cwiseAbs().maxCoeff() > 1e3) continue;
      for (const double multiplier : {-2.0, 3.0}) {
        for (const auto policy : {Definiteness::projected, Definiteness::absolute}) {
          INFO(c.name << ", " << name);
          const Mat9 A = closed_form(*c.material, F, multiplier, 0, policy);
          REQUIRE(A.allFinite());
          const double lowest = Eigen::SelfAdjointEigenSolver<Mat9>(A).eigenvalues()[0];
          CHECK(lowest > -1e-12 * std::max(c.scale, A.cwiseAbs().maxCoeff()));
        }
      }
    }
  }
}
