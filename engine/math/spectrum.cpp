#include "engine/math/spectrum.h"

namespace isochor {

namespace {

constexpr int kScaling[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};

Lanes positive(Definiteness policy, const Lanes& v) {
  return policy == Definiteness::absolute ? magnitude(v) : larger(v, broadcast(0));
}

}  // namespace

void set_invariant(const Svd3& svd, const InvariantHessian& gamma, Spectrum& out) {
  const Lanes* s = svd.sigma;
  const Lanes g[3] = {s[1] * s[2], s[2] * s[0], s[0] * s[1]};
  for (int i = 0; i < 3; ++i) {
    out.twist[i] = gamma.I;
    out.flip[i] = gamma.I;
    for (int j = i; j < 3; ++j) {
      Lanes v = gamma.F * s[i] * s[j] + gamma.FG * (s[i] * g[j] + g[i] * s[j]);
      if (i == j) v += gamma.I;
      out.scaling[kScaling[i][j]] = v;
    }
  }
  add_volume(svd, gamma.G, gamma.H, out);
}

void add_volume(const Svd3& svd, const Lanes& G, const Lanes& H, Spectrum& spectrum) {
  const Lanes* s = svd.sigma;
  const Lanes g[3] = {s[1] * s[2], s[2] * s[0], s[0] * s[1]};
  for (int i = 0; i < 3; ++i) {
    spectrum.twist[i] += H * s[i];
    spectrum.flip[i] -= H * s[i];
    for (int j = i; j < 3; ++j) {
      Lanes& v = spectrum.scaling[kScaling[i][j]];
      v += G * g[i] * g[j];
      if (i != j) v += H * s[3 - i - j];
    }
  }
}

void make_definite(Definiteness policy, Spectrum& spectrum) {
  if (policy == Definiteness::exact) return;
  for (int i = 0; i < 3; ++i) {
    spectrum.twist[i] = positive(policy, spectrum.twist[i]);
    spectrum.flip[i] = positive(policy, spectrum.flip[i]);
  }
  Lanes values[3], Q[9];
  symmetric_eigen3(spectrum.scaling, values, Q);
  const LaneMask wrong = (values[0] < 0) | (values[1] < 0) | (values[2] < 0);
  if (!any(wrong)) return;
  for (Lanes& v : values) v = positive(policy, v);
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      Lanes sum = values[0] * Q[3 * i] * Q[3 * j];
      for (int k = 1; k < 3; ++k) sum += values[k] * Q[3 * i + k] * Q[3 * j + k];
      Lanes& v = spectrum.scaling[kScaling[i][j]];
      v = wrong ? sum : v;
    }
  }
}

void assemble(const Svd3& svd, const Spectrum& spectrum, Lanes A[45]) {
  // A = sum_ab S_ab m_a m_b^T over the nine matrices m = u_p v_q^T, where S couples (p p) with (q q) and (p
  // q) with (q p) only: T = S m first, then the outer products.
  const Lanes zero = broadcast(0);
  for (int i = 0; i < 45; ++i) A[i] = zero;
  for (int p = 0; p < 3; ++p) {
    for (int q = 0; q < 3; ++q) {
      Lanes m[9], t[9];
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) m[3 * i + j] = svd.U[3 * i + p] * svd.V[3 * j + q];
      }
      if (p == q) {
        Lanes D[9];  // U S V^T with the p-th row of the scalings
        for (int j = 0; j < 3; ++j) {
          for (int k = 0; k < 3; ++k) D[3 * j + k] = spectrum.scaling[kScaling[p][k]] * svd.V[3 * j + k];
        }
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) {
            t[3 * i + j] =
                svd.U[3 * i] * D[3 * j] + svd.U[3 * i + 1] * D[3 * j + 1] + svd.U[3 * i + 2] * D[3 * j + 2];
          }
        }
      } else {
        const int axis = 3 - p - q;
        const Lanes same = 0.5 * (spectrum.flip[axis] + spectrum.twist[axis]);
        const Lanes other = 0.5 * (spectrum.flip[axis] - spectrum.twist[axis]);
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) {
            t[3 * i + j] = same * m[3 * i + j] + other * (svd.U[3 * i + q] * svd.V[3 * j + p]);
          }
        }
      }
      int k = 0;
      for (int i = 0; i < 9; ++i) {
        for (int j = 0; j <= i; ++j, ++k) A[k] += m[i] * t[j];
      }
    }
  }
}

}  // namespace isochor
