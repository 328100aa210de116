// From derivatives in deformation gradients to those in nodes: F = sum_a x_a (x) B_a.
#pragma once

#include <cstddef>

#include "engine/base/base.h"

namespace isochor {

// Place of (i, j) in a packed symmetric matrix.
constexpr std::size_t packed(std::size_t i, std::size_t j) {
  return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i;
}

// gradient_a += w P B_a.
inline void contract_gradient(const double P[9], double w, const Vec3* B, std::size_t n, Vec3* gradient) {
  for (std::size_t a = 0; a < n; ++a) {
    gradient[a] +=
        w * Vec3{P[0] * B[a].x + P[1] * B[a].y + P[2] * B[a].z, P[3] * B[a].x + P[4] * B[a].y + P[5] * B[a].z,
                 P[6] * B[a].x + P[7] * B[a].y + P[8] * B[a].z};
  }
}

// hessian block (a, b) += w B_a A B_b for all b <= a, with the 9x9 A of one point, packed.
inline void contract_hessian(const double A[45], double w, const Vec3* B, std::size_t n, Mat3* blocks) {
  // Regrouped so that the inner loops run over contiguous numbers: by_l[l][k][i][j] = w A[(i k)(j l)].
  double by_l[3][27];
  for (std::size_t l = 0; l < 3; ++l) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) by_l[l][9 * k + 3 * i + j] = w * A[packed(3 * i + k, 3 * j + l)];
      }
    }
  }
  for (std::size_t b = 0; b < n; ++b) {
    double t[27];
    for (std::size_t e = 0; e < 27; ++e)
      t[e] = by_l[0][e] * B[b].x + by_l[1][e] * B[b].y + by_l[2][e] * B[b].z;
    for (std::size_t a = b; a < n; ++a) {
      double* block = blocks[a * (a + 1) / 2 + b].m.data();
      for (std::size_t e = 0; e < 9; ++e) block[e] += B[a].x * t[e] + B[a].y * t[9 + e] + B[a].z * t[18 + e];
    }
  }
}

}  // namespace isochor
