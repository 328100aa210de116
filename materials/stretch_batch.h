// Turns an energy density in principal stretches, written for one deformation gradient, into the batch
// interface of the engine.
#pragma once

#include <cmath>
#include <limits>

#include "engine/elements/material.h"

namespace isochor {

// Psi(sigma_0, sigma_1, sigma_2), symmetric in its arguments, with all that its derivatives in F need. The
// quotients are asked of the energy because only it knows a form that keeps its digits where stretches
// coincide; i, j, k are all different.
struct StretchResponse {
  double psi = 0;
  double d[3] = {};      // Psi_i
  double dd[6] = {};     // Psi_ij, packed 00, 11, 22, 01, 02, 12
  double twist[3] = {};  // (Psi_j + Psi_k) / (sigma_j + sigma_k)
  double flip[3] = {};   // (Psi_j - Psi_k) / (sigma_j - sigma_k)
};

// Place of (i, j), i != j, in StretchResponse::dd.
constexpr int off_diagonal(int i, int j) {
  return 2 + i + j;
}

// Adds a function of J = sigma_0 sigma_1 sigma_2 with its derivatives.
inline void add_volume_term(const double s[3], double value, double first, double second,
                            StretchResponse& r) {
  const double g[3] = {s[1] * s[2], s[2] * s[0], s[0] * s[1]};
  r.psi += value;
  for (int i = 0; i < 3; ++i) {
    r.d[i] += first * g[i];
    r.dd[i] += second * g[i] * g[i];
    r.twist[i] += first * s[i];
    r.flip[i] -= first * s[i];
    for (int j = i + 1; j < 3; ++j) r.dd[off_diagonal(i, j)] += second * g[i] * g[j] + first * s[3 - i - j];
  }
}

// `Energy` has: StretchResponse operator()(Want, const double sigma[3]) const, pure; psi = +infinity outside
// its domain, and whatever is no finite number is taken as such. sigma_2 is negative for inverted F.
template <class Energy>
class StretchMaterial final : public Material {
 public:
  StretchMaterial(std::string_view name, Energy energy) : name_(name), energy_(std::move(energy)) {}
  std::string_view name() const override { return name_; }
  void describe(Fingerprint& f) const override { f.add(name_, energy_); }

  void evaluate(Want want, const PointBatch& points, ResponseBatch& r) const override {
    Lanes F[9];
    for (int i = 0; i < 9; ++i) F[i] = load(points.F[i]);
    Svd3 svd;
    svd3(F, svd);
    Spectrum spectrum;
    Lanes d[3], psi;
    respond(want, svd, psi, d, spectrum);
    store(psi, r.psi);
    if (want == Want::value) return;
    for (int i = 0; i < 3; ++i) {
      Lanes u[3];
      for (int k = 0; k < 3; ++k) u[k] = svd.U[3 * i + k] * d[k];
      for (int j = 0; j < 3; ++j) {
        store(u[0] * svd.V[3 * j] + u[1] * svd.V[3 * j + 1] + u[2] * svd.V[3 * j + 2], r.P[3 * i + j]);
      }
    }
    if (want == Want::gradient) return;
    Lanes A[45];
    assemble(svd, spectrum, A);
    for (int i = 0; i < 45; ++i) store(A[i], r.A[i]);
  }

  void spectrum(const PointBatch&, const Svd3& svd, Spectrum& out) const override {
    Lanes d[3], psi;
    respond(Want::hessian, svd, psi, d, out);
  }

 private:
  void respond(Want want, const Svd3& svd, Lanes& psi, Lanes d[3], Spectrum& out) const {
    for (int l = 0; l < kLanes; ++l) {
      const double s[3] = {svd.sigma[0][l], svd.sigma[1][l], svd.sigma[2][l]};
      StretchResponse e = energy_(want, s);
      if (!std::isfinite(e.psi)) {
        e = {};
        e.psi = std::numeric_limits<double>::infinity();
      }
      psi[l] = e.psi;
      for (int i = 0; i < 3; ++i) d[i][l] = e.d[i];
      if (want != Want::hessian) continue;
      for (int i = 0; i < 3; ++i) out.twist[i][l] = e.twist[i], out.flip[i][l] = e.flip[i];
      for (int i = 0; i < 6; ++i) out.scaling[i][l] = e.dd[i];
    }
  }

  std::string_view name_;
  Energy energy_;
};

}  // namespace isochor
