#include "engine/math/svd3.h"

namespace isochor {

namespace {

// Quadratic convergence makes five sweeps plenty; the bound is for matrices that are no numbers.
constexpr int kMostSweeps = 12;
// Two columns are orthogonal when the cosine of their angle is below 2^-50.
constexpr double kCosineSquared = 0x1p-100;

// Cosine and sine of the rotation that makes (a, c; c, b) diagonal; the identity where `turn` is false.
struct Rotation {
  Lanes cosine, sine, tangent;
};
Rotation jacobi(const Lanes& a, const Lanes& b, const Lanes& c, const LaneMask& turn) {
  const Lanes one = broadcast(1), zero = broadcast(0);
  const Lanes zeta = (b - a) / (2 * (turn ? c : one));
  const Lanes root = magnitude(zeta) + square_root(1 + zeta * zeta);
  const Lanes t = turn ? (zeta < 0 ? -one : one) / root : zero;
  const Lanes cosine = 1 / square_root(1 + t * t);
  return {cosine, cosine * t, t};
}

void rotate_columns(Lanes* m, int p, int q, const Rotation& r) {
  for (int row = 0; row < 9; row += 3) {
    const Lanes x = m[row + p], y = m[row + q];
    m[row + p] = r.cosine * x - r.sine * y;
    m[row + q] = r.sine * x + r.cosine * y;
  }
}

Lanes column_dot(const Lanes* m, int p, int q) {
  return m[p] * m[q] + m[3 + p] * m[3 + q] + m[6 + p] * m[6 + q];
}

// Puts the longer column first; one sign changes, so that determinants stay.
void order_columns(Lanes* B, Lanes* V, int p, int q) {
  const LaneMask swap = column_dot(B, p, p) < column_dot(B, q, q);
  for (Lanes* m : {B, V}) {
    for (int row = 0; row < 9; row += 3) {
      const Lanes x = m[row + p], y = m[row + q];
      m[row + p] = swap ? y : x;
      m[row + q] = swap ? -x : y;
    }
  }
}

void cross_product(const Lanes a[3], const Lanes b[3], Lanes c[3]) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    c[i] = a[j] * b[k] - a[k] * b[j];
  }
}

Lanes length(const Lanes a[3]) {
  return square_root(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

// Unit vector along a, or along `other` where a has no length.
void unit_or(const Lanes a[3], const Lanes other[3], Lanes u[3]) {
  const Lanes n = length(a);
  const LaneMask has = n > 0;
  const Lanes safe = has ? n : broadcast(1);
  for (int i = 0; i < 3; ++i) u[i] = has ? a[i] / safe : other[i];
}

// Some unit vector across the unit vector u: with the axis that u leans on least.
void across(const Lanes u[3], Lanes v[3]) {
  const Lanes zero = broadcast(0), one = broadcast(1);
  const Lanes x = magnitude(u[0]), y = magnitude(u[1]), z = magnitude(u[2]);
  const LaneMask first = (x <= y) & (x <= z), second = ~first & (y <= z);
  // The axes are taken so that u = e_0 gives e_1.
  const Lanes axis[3] = {first ? one : zero, second ? one : zero, (first | second) ? zero : one};
  Lanes c[3];
  cross_product(axis, u, c);
  const Lanes n = length(c);
  for (int i = 0; i < 3; ++i) v[i] = c[i] / n;
}

// Left factor and singular values from orthogonal columns B, longest first. The last column of U is the cross
// product of the others, so that the last singular value takes the sign of det F.
void finish(const Lanes B[9], const Lanes& scale, Svd3& out) {
  const Lanes zero = broadcast(0);
  const Lanes b0[3] = {B[0], B[3], B[6]}, b2[3] = {B[2], B[5], B[8]};
  Lanes b1[3] = {B[1], B[4], B[7]};
  const Lanes e0[3] = {broadcast(1), zero, zero};
  Lanes u0[3], u1[3], u2[3], fallback[3];
  unit_or(b0, e0, u0);
  const Lanes lean = u0[0] * b1[0] + u0[1] * b1[1] + u0[2] * b1[2];
  for (int i = 0; i < 3; ++i) b1[i] -= lean * u0[i];
  across(u0, fallback);
  unit_or(b1, fallback, u1);
  cross_product(u0, u1, u2);
  out.sigma[0] = scale * length(b0);
  out.sigma[1] = scale * length(b1);
  out.sigma[2] = scale * (u2[0] * b2[0] + u2[1] * b2[1] + u2[2] * b2[2]);
  for (int i = 0; i < 3; ++i) {
    out.U[3 * i] = u0[i];
    out.U[3 * i + 1] = u1[i];
    out.U[3 * i + 2] = u2[i];
  }
}

}  // namespace

void svd3(const Lanes F[9], Svd3& out) {
  // Squares of very small or very large numbers would leave the range of doubles.
  Lanes size = broadcast(0);
  for (int i = 0; i < 9; ++i) size = larger(size, magnitude(F[i]));
  const LaneMask extreme = (size > 0) & ((size < 1e-60) | (size > 1e60));
  const Lanes scale = extreme ? size : broadcast(1);
  Lanes B[9];
  for (int i = 0; i < 9; ++i) {
    B[i] = F[i] / scale;
    out.V[i] = broadcast(i % 4 == 0 ? 1 : 0);
  }
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    LaneMask turned = {};
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        const Lanes a = column_dot(B, p, p), b = column_dot(B, q, q), c = column_dot(B, p, q);
        const LaneMask turn = c * c > kCosineSquared * a * b;
        turned |= turn;
        const Rotation r = jacobi(a, b, c, turn);
        rotate_columns(B, p, q, r);
        rotate_columns(out.V, p, q, r);
      }
    }
    if (!any(turned)) break;
  }
  order_columns(B, out.V, 0, 1);
  order_columns(B, out.V, 1, 2);
  order_columns(B, out.V, 0, 1);
  finish(B, scale, out);
}

void symmetric_eigen3(const Lanes S[6], Lanes values[3], Lanes Q[9]) {
  Lanes diagonal[3] = {S[0], S[1], S[2]};
  Lanes off[3] = {S[5], S[4], S[3]};  // off[k] couples the two axes other than k
  for (int i = 0; i < 9; ++i) Q[i] = broadcast(i % 4 == 0 ? 1 : 0);
  Lanes size = broadcast(0);
  for (int i = 0; i < 6; ++i) size = larger(size, magnitude(S[i]));
  const Lanes negligible = 0x1p-60 * size;
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    LaneMask turned = {};
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        const int k = 3 - p - q;
        const Lanes c = off[k];
        const LaneMask turn = magnitude(c) > negligible;
        turned |= turn;
        const Rotation r = jacobi(diagonal[p], diagonal[q], c, turn);
        diagonal[p] -= turn ? r.tangent * c : broadcast(0);
        diagonal[q] += turn ? r.tangent * c : broadcast(0);
        off[k] = turn ? broadcast(0) : c;
        // off[q] couples k and p, off[p] couples k and q.
        const Lanes kp = off[q], kq = off[p];
        off[q] = r.cosine * kp - r.sine * kq;
        off[p] = r.sine * kp + r.cosine * kq;
        rotate_columns(Q, p, q, r);
      }
    }
    if (!any(turned)) break;
  }
  for (int i = 0; i < 3; ++i) values[i] = diagonal[i];
}

}  // namespace isochor
