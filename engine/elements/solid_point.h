// What the pools of solids do at one point: the volume J as a function of the deformation gradient, and
// Hessians of energy and volume rows that are made definite as one.
#pragma once

#include "engine/elements/contraction.h"
#include "engine/elements/material.h"

namespace isochor {

// dJ/dF, row-major.
[[gnu::always_inline]] inline void cofactor(const double F[9], double g[9]) {
  g[0] = F[4] * F[8] - F[5] * F[7];
  g[1] = F[5] * F[6] - F[3] * F[8];
  g[2] = F[3] * F[7] - F[4] * F[6];
  g[3] = F[2] * F[7] - F[1] * F[8];
  g[4] = F[0] * F[8] - F[2] * F[6];
  g[5] = F[1] * F[6] - F[0] * F[7];
  g[6] = F[1] * F[5] - F[2] * F[4];
  g[7] = F[2] * F[3] - F[0] * F[5];
  g[8] = F[0] * F[4] - F[1] * F[3];
}

// Adds first * d2J/dF2 + second * g g^T with g = dJ/dF to a packed 9x9.
void add_volume_hessian(const double F[9], const double g[9], double first, double second, double A[45]);

// The Hessian at the points of a batch, into response.A: psi of the material (null: none) with volume rows
// whose multipliers times Phi' are `first` and times Phi'' are `second`. They are made definite as one: their
// sum is often definite where one of them is not.
void definite_point_hessian(Definiteness definiteness, const Material* material, const PointBatch& batch,
                            const Lanes& first, const Lanes& second, ResponseBatch& response);

// blocks (a, b) += c d_a d_b^T for all b <= a.
void add_outer_products(double c, const Vec3* d, std::size_t n, Mat3* blocks);

}  // namespace isochor
