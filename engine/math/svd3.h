// Singular values of 3x3 matrices in the rotation-variant form, several at once.
#pragma once

#include "engine/math/lanes.h"
#include "isochor/export.h"

namespace isochor {

// F = U diag(sigma) V^T with det U = det V = 1 and sigma_0 >= sigma_1 >= |sigma_2|: the last one takes the
// sign of det F. All matrices row-major. Defined for every finite F, singular ones included.
struct Svd3 {
  Lanes U[9], V[9], sigma[3];
};

// One-sided Jacobi rotations: singular values and vectors to a few units of rounding of the largest one,
// small singular values of well-scaled columns to full relative accuracy. The identity comes out exactly.
ISOCHOR_API void svd3(const Lanes F[9], Svd3& out);

// Eigenvalues and eigenvectors (columns of Q, row-major) of symmetric matrices, packed 00, 11, 22, 01, 02,
// 12.
ISOCHOR_API void symmetric_eigen3(const Lanes S[6], Lanes values[3], Lanes Q[9]);

}  // namespace isochor
