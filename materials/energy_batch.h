// Turns an energy density written for one deformation gradient into the batch interface of the engine.
#pragma once

#include <cmath>
#include <limits>

#include "engine/elements/material.h"

namespace isochor {

// Psi(I, J) with I = tr F^T F and J = det F: values of the energy and its partial derivatives.
struct InvariantResponse {
  double psi = 0;
  double I = 0, J = 0;            // d/dI, d/dJ
  double II = 0, IJ = 0, JJ = 0;  // second derivatives
};

// `Energy` has: InvariantResponse operator()(double I, double J) const, pure; psi = +infinity outside its
// domain (whatever is no finite number is taken as such). P = 2 Psi_I F + Psi_J g and A = 2 Psi_I 1 + 4
// Psi_II f f^T + 2 Psi_IJ (f g^T + g f^T) + Psi_JJ g g^T + Psi_J H, g = dJ/dF, H = d2J/dF2 (Smith, de Goes &
// Kim 2018, section 4).
template <class Energy>
class InvariantMaterial final : public Material {
 public:
  InvariantMaterial(std::string_view name, Energy energy) : name_(name), energy_(energy) {}
  std::string_view name() const override { return name_; }
  void describe(Fingerprint& f) const override { f.add(name_, energy_); }

  void evaluate(Want want, const PointBatch& points, ResponseBatch& r) const override {
    double I[kLanes] = {}, J[kLanes], g[9][kLanes];
    const auto& F = points.F;
    for (int i = 0; i < 9; ++i) {
      for (int l = 0; l < kLanes; ++l) I[l] += F[i][l] * F[i][l];
    }
    for (int i = 0; i < 3; ++i) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
      for (int j = 0; j < 3; ++j) {
        const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
        for (int l = 0; l < kLanes; ++l) {
          g[3 * i + j][l] = F[3 * i1 + j1][l] * F[3 * i2 + j2][l] - F[3 * i1 + j2][l] * F[3 * i2 + j1][l];
        }
      }
    }
    for (int l = 0; l < kLanes; ++l) J[l] = F[0][l] * g[0][l] + F[1][l] * g[1][l] + F[2][l] * g[2][l];

    double dI[kLanes], dJ[kLanes], dII[kLanes], dIJ[kLanes], dJJ[kLanes];
    for (int l = 0; l < kLanes; ++l) {
      const InvariantResponse e = respond(I[l], J[l]);
      r.psi[l] = e.psi;
      dI[l] = 2 * e.I;
      dJ[l] = e.J;
      dII[l] = 4 * e.II;
      dIJ[l] = 2 * e.IJ;
      dJJ[l] = e.JJ;
    }
    if (want == Want::value) return;
    for (int i = 0; i < 9; ++i) {
      for (int l = 0; l < kLanes; ++l) r.P[i][l] = dI[l] * F[i][l] + dJ[l] * g[i][l];
    }
    if (want == Want::gradient) return;
    int k = 0;
    for (int i = 0; i < 9; ++i) {
      for (int j = 0; j <= i; ++j, ++k) {
        for (int l = 0; l < kLanes; ++l) {
          r.A[k][l] = (i == j ? dI[l] : 0.0) + dII[l] * F[i][l] * F[j][l] +
                      dIJ[l] * (F[i][l] * g[j][l] + g[i][l] * F[j][l]) + dJJ[l] * g[i][l] * g[j][l];
        }
      }
    }
    add_volume_hessian(points, dJ, r);
  }

  void spectrum(const PointBatch&, const Svd3& svd, Spectrum& out) const override {
    InvariantHessian gamma;
    for (int l = 0; l < kLanes; ++l) {
      const double a = svd.sigma[0][l], b = svd.sigma[1][l], c = svd.sigma[2][l];
      const InvariantResponse e = respond(a * a + b * b + c * c, a * b * c);
      gamma.I[l] = 2 * e.I;
      gamma.F[l] = 4 * e.II;
      gamma.G[l] = e.JJ;
      gamma.H[l] = e.J;
      gamma.FG[l] = 2 * e.IJ;
    }
    set_invariant(svd, gamma, out);
  }

  const Energy& energy() const { return energy_; }

 private:
  InvariantResponse respond(double I, double J) const {
    const InvariantResponse e = energy_(I, J);
    if (std::isfinite(e.psi)) return e;
    InvariantResponse none;
    none.psi = std::numeric_limits<double>::infinity();
    return none;
  }
  static void add_volume_hessian(const PointBatch& points, const double* scale, ResponseBatch& r) {
    for (int i = 1; i < 3; ++i) {
      for (int j = 0; j < i; ++j) {
        const int m = 3 - i - j;
        const double eps = (j + 1) % 3 == i ? -1.0 : 1.0;
        for (int k = 0; k < 3; ++k) {
          for (int l = 0; l < 3; ++l) {
            if (k == l) continue;
            const double sign = (k + 1) % 3 == l ? eps : -eps;
            const int row = 3 * i + k, col = 3 * j + l, f = 3 * m + (3 - k - l);
            double* a = r.A[row * (row + 1) / 2 + col];
            for (int lane = 0; lane < kLanes; ++lane) a[lane] += sign * scale[lane] * points.F[f][lane];
          }
        }
      }
    }
  }

  std::string_view name_;
  Energy energy_;
};

}  // namespace isochor
