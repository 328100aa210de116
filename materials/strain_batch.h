// Turns an energy density in I = tr C, II = (I^2 - tr C^2)/2 and J = det F, C = F^T F, written for a batch of
// deformation gradients, into the interface of the engine.
#pragma once

#include <limits>

#include "engine/elements/material.h"

namespace isochor {

// Psi(I, II, J) with its partial derivatives. Where psi is no finite number the energy has no value.
struct StrainResponse {
  Lanes psi{};
  Lanes I{}, II{}, J{};
  Lanes I_I{}, I_II{}, II_II{}, I_J{}, II_J{}, J_J{};
};

// `Energy` has: StrainResponse operator()(const Lanes& I, const Lanes& II, const Lanes& J) const, pure, and
// kSecond: whether II matters to it. With f = vec F, v = vec (I F - F C) = dII/dF / 2, g = dJ/dF:
//   P = 2 Psi_I f + 2 Psi_II v + Psi_J g,
//   A = 2 Psi_I 1 + 2 Psi_II (I 1 + 2 f f^T - 1 x C - B x 1 - F x F^T) + Psi_J H
//       + [f v g] [4 Psi_I_I  4 Psi_I_II   2 Psi_I_J ]
//                 [4 Psi_I_II 4 Psi_II_II  2 Psi_II_J] [f v g]^T,
//                 [2 Psi_I_J  2 Psi_II_J   Psi_J_J   ]
// where the products in the bracket are d2II/dF2 / 2 written out in add_second() and H = d2J/dF2.
template <class Energy>
class StrainMaterial final : public Material {
 public:
  StrainMaterial(std::string_view name, Energy energy) : name_(name), energy_(std::move(energy)) {}
  std::string_view name() const override { return name_; }
  void describe(Fingerprint& f) const override { f.add(name_, energy_); }

  void evaluate(Want want, const PointBatch& points, ResponseBatch& r) const override {
    Lanes F[9], g[9], v[9], C[6], I = {}, II = {};
    for (int i = 0; i < 9; ++i) F[i] = load(points.F[i]), I += F[i] * F[i];
    cofactor(F, g);
    const Lanes J = F[0] * g[0] + F[1] * g[1] + F[2] * g[2];
    if constexpr (Energy::kSecond) {
      for (int i = 0; i < 9; ++i) II += g[i] * g[i];
    }
    const StrainResponse e = respond(I, II, J);
    store(e.psi, r.psi);
    if (want == Want::value) return;
    if constexpr (Energy::kSecond) {
      for (Lanes& c : C) c = Lanes{};
      for (int k = 0; k < 9; k += 3) {
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j <= i; ++j) C[packed(i, j)] += F[k + i] * F[k + j];
        }
      }
      for (int i = 0; i < 9; i += 3) {
        for (int j = 0; j < 3; ++j) {
          v[i + j] = I * F[i + j];
          for (int k = 0; k < 3; ++k) v[i + j] -= F[i + k] * C[packed(k, j)];
        }
      }
    }
    for (int i = 0; i < 9; ++i) {
      Lanes p = 2 * e.I * F[i] + e.J * g[i];
      if constexpr (Energy::kSecond) p += 2 * e.II * v[i];
      store(p, r.P[i]);
    }
    if (want == Want::gradient) return;
    hessian(e, F, g, v, C, I, r);
  }

  void spectrum(const PointBatch&, const Svd3& svd, Spectrum& out) const override {
    const Lanes* s = svd.sigma;
    const Lanes square[3] = {s[0] * s[0], s[1] * s[1], s[2] * s[2]}, I = square[0] + square[1] + square[2];
    const Lanes g[3] = {s[1] * s[2], s[2] * s[0], s[0] * s[1]}, II = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
    const StrainResponse e = respond(I, Energy::kSecond ? II : Lanes{}, s[0] * g[0]);
    Lanes v[3];
    for (int i = 0; i < 3; ++i) v[i] = s[i] * (I - square[i]);
    const auto outer = [&](int i, int j) {
      Lanes sum = 4 * e.I_I * s[i] * s[j] + 2 * e.I_J * (s[i] * g[j] + g[i] * s[j]) + e.J_J * g[i] * g[j];
      if constexpr (Energy::kSecond) {
        sum += 4 * (e.I_II * (s[i] * v[j] + v[i] * s[j]) + e.II_II * v[i] * v[j]) +
               2 * e.II_J * (v[i] * g[j] + g[i] * v[j]);
      }
      return sum;
    };
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      out.twist[i] = 2 * e.I + e.J * s[i];
      out.flip[i] = 2 * e.I - e.J * s[i];
      out.scaling[i] = outer(i, i) + 2 * e.I;
      // The pair (j, k), packed 01, 02, 12.
      const int pair = 2 + j + k;
      out.scaling[pair] = outer(j, k) + e.J * s[i];
      if constexpr (Energy::kSecond) {
        out.twist[i] += 2 * e.II * (square[i] + g[i]);
        out.flip[i] += 2 * e.II * (square[i] - g[i]);
        out.scaling[i] += 2 * e.II * (square[j] + square[k]);
        out.scaling[pair] += 4 * e.II * g[i];
      }
    }
  }

  const Energy& energy() const { return energy_; }

 private:
  static constexpr int packed(int i, int j) { return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i; }

  static void cofactor(const Lanes F[9], Lanes g[9]) {
    for (int i = 0; i < 3; ++i) {
      const int i1 = 3 * ((i + 1) % 3), i2 = 3 * ((i + 2) % 3);
      for (int j = 0; j < 3; ++j) {
        const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
        g[3 * i + j] = F[i1 + j1] * F[i2 + j2] - F[i1 + j2] * F[i2 + j1];
      }
    }
  }

  // Infinite, with derivatives of zero, where there is no value.
  StrainResponse respond(const Lanes& I, const Lanes& II, const Lanes& J) const {
    StrainResponse e = energy_(I, II, J);
    const LaneMask none = ~(magnitude(e.psi) <= std::numeric_limits<double>::max());
    if (!any(none)) return e;
    e.psi = none ? broadcast(std::numeric_limits<double>::infinity()) : e.psi;
    for (Lanes* d : {&e.I, &e.II, &e.J, &e.I_I, &e.I_II, &e.II_II, &e.I_J, &e.II_J, &e.J_J}) {
      *d = none ? Lanes{} : *d;
    }
    return e;
  }

  static void hessian(const StrainResponse& e, const Lanes F[9], const Lanes g[9], const Lanes v[9],
                      const Lanes C[6], const Lanes& I, ResponseBatch& r) {
    Lanes p[9], q[9], w[9];  // the rows of [f v g] times the matrix of second derivatives
    const Lanes II_II = 4 * e.II_II, I_II = 4 * e.I_II, I_J = 2 * e.I_J, II_J = 2 * e.II_J;
    const Lanes I_I = 4 * e.I_I + 4 * e.II;  // f f^T of d2II/dF2 with it
    for (int i = 0; i < 9; ++i) {
      p[i] = I_I * F[i] + I_J * g[i];
      w[i] = I_J * F[i] + e.J_J * g[i];
      if constexpr (Energy::kSecond) {
        p[i] += I_II * v[i];
        w[i] += II_J * v[i];
        q[i] = I_II * F[i] + II_II * v[i] + II_J * g[i];
      }
    }
    const Lanes twice = 2 * e.II, diagonal = 2 * e.I + twice * I;
    const Lanes JF[9] = {e.J * F[0], e.J * F[1], e.J * F[2], e.J * F[3], e.J * F[4],
                         e.J * F[5], e.J * F[6], e.J * F[7], e.J * F[8]};
    Lanes B[6];
    if constexpr (Energy::kSecond) {
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j <= i; ++j) {
          B[packed(i, j)] = F[3 * i] * F[3 * j] + F[3 * i + 1] * F[3 * j + 1] + F[3 * i + 2] * F[3 * j + 2];
        }
      }
    }
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const int row = 3 * i + j;
        for (int col = 0; col <= row; ++col) {
          const int k = col / 3, l = col % 3;
          Lanes a = F[row] * p[col] + g[row] * w[col];
          if (row == col) a += diagonal;
          if constexpr (Energy::kSecond) {
            a += v[row] * q[col];
            Lanes t = F[3 * i + l] * F[3 * k + j];
            if (i == k) t += C[packed(j, l)];
            if (j == l) t += B[packed(i, k)];
            a -= twice * t;
          }
          if (i != k && j != l) {
            const int third = 3 * (3 - i - k) + (3 - j - l);
            const bool even = ((i + 1) % 3 == k) == ((j + 1) % 3 == l);
            a += even ? JF[third] : -JF[third];
          }
          store(a, r.A[row * (row + 1) / 2 + col]);
        }
      }
    }
  }

  std::string_view name_;
  Energy energy_;
};

}  // namespace isochor
