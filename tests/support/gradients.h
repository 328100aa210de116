// Deformation gradients of every kind: random, nearly degenerate, crushed, inverted.
#pragma once

#include <Eigen/Geometry>
#include <random>
#include <string>
#include <vector>

#include "engine/math/svd3.h"

namespace test {

using Mat = Eigen::Matrix3d;

struct NamedGradient {
  std::string name;
  Mat F;
};

inline Mat random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
      .normalized()
      .toRotationMatrix();
}

// Singular values that are well apart, close, equal, zero, of both signs; turned at random.
inline std::vector<NamedGradient> all_gradients() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<NamedGradient> out;
  for (int k = 0; k < 20; ++k) {
    out.push_back({"random " + std::to_string(k), Mat::NullaryExpr([&] { return 2 * unit(random); })});
  }
  const std::vector<std::pair<std::string, Eigen::Vector3d>> kinds = {
      {"rest", {1, 1, 1}},
      {"near rest", {1 + 1e-9, 1, 1 - 3e-10}},
      {"nearly equal", {1.3, 1.3 - 1e-14, 0.7}},
      {"two equal", {1.2, 0.8, 0.8}},
      {"plane", {1.1, 0.9, 0}},
      {"line", {1.4, 0, 0}},
      {"point", {0, 0, 0}},
      {"nearly a plane", {1.1, 0.9, 1e-11}},
      {"nearly a line", {1.4, 1e-9, 1e-13}},
      {"mirrored", {1, 1, -1}},
      {"inverted", {1.5, 0.7, -0.3}},
      {"just inverted", {1.5, 0.7, -1e-12}},
      {"inverted, opposite", {1.5, 0.6, -0.6}},
      {"long", {12, 0.3, 0.25}},
      {"tiny", {3e-200, 2e-200, -1e-201}},
      {"huge", {3e150, 2e150, 1e140}}};
  for (const auto& [name, sigma] : kinds) {
    out.push_back({name + ", diagonal", sigma.asDiagonal()});
    for (int k = 0; k < 3; ++k) {
      const Mat U = random_rotation(random), V = random_rotation(random);
      out.push_back({name + ", turned", U * sigma.asDiagonal() * V.transpose()});
    }
  }
  return out;
}

struct LaneSvd {
  Mat U, V;
  Eigen::Vector3d sigma;
};

inline LaneSvd svd_of(const Mat& F) {
  isochor::Lanes f[9];
  for (int i = 0; i < 9; ++i) f[i] = isochor::broadcast(F(i / 3, i % 3));
  isochor::Svd3 svd;
  isochor::svd3(f, svd);
  LaneSvd out;
  for (int i = 0; i < 9; ++i) out.U(i / 3, i % 3) = svd.U[i][0], out.V(i / 3, i % 3) = svd.V[i][0];
  for (int i = 0; i < 3; ++i) out.sigma[i] = svd.sigma[i][0];
  return out;
}

}  // namespace test
