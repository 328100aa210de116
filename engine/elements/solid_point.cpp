#include "engine/elements/solid_point.h"

namespace isochor {

// The entry of (i k)(j l) is first * eps_ijm eps_kln F_mn + second * g_ik g_jl.
void add_volume_hessian(const double F[9], const double g[9], double first, double second, double A[45]) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const std::size_t m = 3 - i - j;
      const double eps_ijm = (j + 1) % 3 == i ? -1.0 : 1.0;  // (i, j, m) with i > j
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t l = 0; l < 3; ++l) {
          if (k == l) continue;
          const std::size_t n = 3 - k - l;
          const double eps_kln = (k + 1) % 3 == l ? 1.0 : -1.0;
          A[packed(3 * i + k, 3 * j + l)] += first * eps_ijm * eps_kln * F[3 * m + n];
        }
      }
    }
  }
  if (second == 0) return;
  for (std::size_t i = 0; i < 9; ++i) {
    for (std::size_t j = 0; j <= i; ++j) A[packed(i, j)] += second * g[i] * g[j];
  }
}

void definite_point_hessian(Definiteness definiteness, const Material* material, const PointBatch& batch,
                            const Lanes& first, const Lanes& second, ResponseBatch& response) {
  Lanes F[9], A[45];
  for (int i = 0; i < 9; ++i) F[i] = load(batch.F[i]);
  Svd3 svd;
  svd3(F, svd);
  Spectrum spectrum = {};
  if (material) material->spectrum(batch, svd, spectrum);
  add_volume(svd, second, first, spectrum);
  make_definite(definiteness, spectrum);
  assemble(svd, spectrum, A);
  for (int i = 0; i < 45; ++i) store(A[i], response.A[i]);
  if (material) material->add_anisotropic(definiteness, batch, response);
}

void add_outer_products(double c, const Vec3* d, std::size_t n, Mat3* blocks) {
  for (std::size_t b = 0; b < n; ++b) {
    for (std::size_t a = b; a < n; ++a) {
      double* block = blocks[a * (a + 1) / 2 + b].m.data();
      for (std::size_t e = 0; e < 9; ++e)
        block[e] += c * d[a][static_cast<int>(e / 3)] * d[b][static_cast<int>(e % 3)];
    }
  }
}

}  // namespace isochor
