// The Hessian of an isotropic energy in closed form: nine modes in the frame of the singular vectors of F.
//
// With F = U diag(sigma) V^T, three twists (U D V^T, D antisymmetric about an axis), three flips (D symmetric
// off the diagonal) and three scalings (D diagonal) span all changes of F, and the second derivative of any
// function of the singular values only couples the scalings (Smith, de Goes & Kim 2018, section 4; for
// principal stretches one by one: Zhu 2021, Stomakhin et al. 2012).
#pragma once

#include "engine/math/svd3.h"
#include "isochor/export.h"

namespace isochor {

struct Spectrum {
  Lanes twist[3];    // (Psi_j + Psi_k) / (sigma_j + sigma_k) for the axis i, j and k the others [Pa]
  Lanes flip[3];     // (Psi_j - Psi_k) / (sigma_j - sigma_k) [Pa]
  Lanes scaling[6];  // Psi_ij, packed 00, 11, 22, 01, 02, 12 [Pa]
};

// Second derivatives of an energy in I = tr F^T F and J = det F: A = gamma_I 1 + gamma_F f f^T + gamma_G g
// g^T + gamma_H H + gamma_FG (f g^T + g f^T), with f = vec F, g = dJ/dF and H = d2J/dF2.
struct InvariantHessian {
  Lanes I, F, G, H, FG;
};
ISOCHOR_API void set_invariant(const Svd3& svd, const InvariantHessian& gamma, Spectrum& out);

// Adds gamma_G g g^T + gamma_H H: what a function of J alone contributes, a volume row with its multiplier
// among them.
ISOCHOR_API void add_volume(const Svd3& svd, const Lanes& G, const Lanes& H, Spectrum& spectrum);

// Negative eigenvalues raised to zero, or turned positive, as the policy says; `exact` changes nothing.
ISOCHOR_API void make_definite(Definiteness policy, Spectrum& spectrum);

// The 9x9 matrix: lower triangle packed, A[i (i + 1) / 2 + j], j <= i, rows as F[3 i + j].
ISOCHOR_API void assemble(const Svd3& svd, const Spectrum& spectrum, Lanes A[45]);

}  // namespace isochor
