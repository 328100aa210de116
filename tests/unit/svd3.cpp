// Singular values in the rotation-variant form: what the header promises, for matrices of every kind.
#include "engine/math/svd3.h"

#include <Eigen/Dense>
#include <random>

#include "catch.h"
#include "support/gradients.h"

using namespace isochor;
using test::Mat;

TEST_CASE("singular values multiply back, with proper rotations, in order, the last one signed") {
  for (const auto& [name, F] : test::all_gradients()) {
    INFO(name);
    const test::LaneSvd svd = test::svd_of(F);
    const double size = F.cwiseAbs().maxCoeff();
    CHECK((svd.U * svd.sigma.asDiagonal() * svd.V.transpose() - F).cwiseAbs().maxCoeff() <= 4e-15 * size);
    CHECK((svd.U.transpose() * svd.U - Mat::Identity()).cwiseAbs().maxCoeff() < 4e-15);
    CHECK((svd.V.transpose() * svd.V - Mat::Identity()).cwiseAbs().maxCoeff() < 4e-15);
    CHECK(svd.U.determinant() == Approx(1).epsilon(1e-14));
    CHECK(svd.V.determinant() == Approx(1).epsilon(1e-14));
    CHECK(svd.sigma[0] >= svd.sigma[1]);
    CHECK(svd.sigma[1] >= std::abs(svd.sigma[2]) - 4e-15 * size);
    CHECK(svd.sigma[1] >= 0);
    const Eigen::Vector3d reference = Eigen::JacobiSVD<Mat>(F).singularValues();
    for (int i = 0; i < 3; ++i) CHECK(std::abs(std::abs(svd.sigma[i]) - reference[i]) <= 4e-15 * size);
    if (std::abs(F.determinant()) > 1e-12 * size * size * size) {
      CHECK((svd.sigma[2] < 0) == (F.determinant() < 0));
    }
  }
}

TEST_CASE("the identity and diagonal matrices come out exactly") {
  for (const Mat& F : {Mat(Mat::Identity()), Mat(Eigen::Vector3d(3, 2, 0.5).asDiagonal())}) {
    const test::LaneSvd svd = test::svd_of(F);
    CHECK(svd.U == Mat::Identity());
    CHECK(svd.V == Mat::Identity());
    CHECK(svd.sigma == F.diagonal());
  }
}

TEST_CASE("a lane of the singular values does not see its neighbors") {
  const auto all = test::all_gradients();
  for (std::size_t k = 0; k < all.size(); ++k) {
    std::vector<Mat> batch;
    for (std::size_t l = 0; l < kLanes; ++l) batch.push_back(all[(k + 7 * l) % all.size()].F);
    Lanes F[9];
    for (int i = 0; i < 9; ++i) {
      for (int l = 0; l < kLanes; ++l) F[i][l] = batch[static_cast<std::size_t>(l)](i / 3, i % 3);
    }
    Svd3 svd;
    svd3(F, svd);
    const test::LaneSvd alone = test::svd_of(batch[0]);
    for (int i = 0; i < 3; ++i) CHECK(svd.sigma[i][0] == alone.sigma[i]);
    for (int i = 0; i < 9; ++i) CHECK(svd.U[i][0] == alone.U(i / 3, i % 3));
    for (int i = 0; i < 9; ++i) CHECK(svd.V[i][0] == alone.V(i / 3, i % 3));
  }
}

TEST_CASE("what is no number gives no endless loop") {
  Lanes F[9];
  for (Lanes& f : F) f = broadcast(std::nan(""));
  Svd3 svd;
  svd3(F, svd);
  CHECK(std::isnan(svd.sigma[0][0] + svd.sigma[1][0] + svd.sigma[2][0]));
}

TEST_CASE("symmetric 3x3 eigenvalues agree with the dense solver") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int trial = 0; trial < 50; ++trial) {
    Lanes S[6], values[3], Q[9];
    for (Lanes& s : S) {
      for (int l = 0; l < kLanes; ++l) s[l] = unit(random) * std::pow(10, 4 * unit(random));
    }
    symmetric_eigen3(S, values, Q);
    for (int l = 0; l < kLanes; ++l) {
      Mat M, V;
      M << S[0][l], S[3][l], S[4][l], S[3][l], S[1][l], S[5][l], S[4][l], S[5][l], S[2][l];
      for (int i = 0; i < 9; ++i) V(i / 3, i % 3) = Q[i][l];
      Eigen::Vector3d ours(values[0][l], values[1][l], values[2][l]);
      CHECK((V * ours.asDiagonal() * V.transpose() - M).norm() < 1e-14 * M.norm());
      std::sort(ours.data(), ours.data() + 3);
      const Eigen::Vector3d reference = Eigen::SelfAdjointEigenSolver<Mat>(M).eigenvalues();
      CHECK((ours - reference).norm() < 1e-14 * M.norm());
    }
  }
}
