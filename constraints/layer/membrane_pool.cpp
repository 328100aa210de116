#include "constraints/layer/membrane_pool.h"

#include <algorithm>

namespace isochor {

// With K = adj C = dq/dC: S = 2 W_I 1 + 2 W_q K and dS/dE = 4 W_qq K K + 2 W_q M, where M is the constant
// derivative of K by E.
PlaneResponse MembranePool::isotropic(const PlaneStrain& e, bool hessian) const {
  const FaceResponse w = respond(e.trace_minus_2(), e.q_minus_1());
  PlaneResponse r;
  r.value = w.value;
  const double K[3] = {1 + 2 * e.e22, 1 + 2 * e.e11, -e.g};
  // The ones of 2 W_I 1 and 2 W_q K cancel at rest: taken together first.
  const double both = 2 * (w.I + w.q);
  r.S[0] = both + 4 * w.q * e.e22;
  r.S[1] = both + 4 * w.q * e.e11;
  r.S[2] = -2 * w.q * e.g;
  if (!hessian) return r;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) r.D[i][j] = 4 * w.qq * K[i] * K[j];
  }
  r.D[0][1] += 4 * w.q;
  r.D[1][0] += 4 * w.q;
  r.D[2][2] -= 2 * w.q;
  return r;
}

PlaneResponse MembranePool::plane(std::size_t, const PlaneStrain& e, double, bool hessian) const {
  return isotropic(e, hessian);
}

// With F = R V0, R the rotation of the frame and C = V0^2: forces per length of the sheet as it is are
// F S F^T / det V0, and the Cauchy stress is that over the thickness as it is.
MembranePool::Stress MembranePool::stress(Index face, std::span<const Vec3> x, std::span<const Vec3> rest,
                                          double t, double thickness) const {
  const PlaneStrain e = strain(face, 0, x, rest);
  const double q = 1 + e.q_minus_1();
  Stress out;
  out.across[0] = direction(e.f1);
  out.across[1] = direction(e.f2 - dot(e.f2, out.across[0]) * out.across[0]);
  if (!(q > 0)) return out;
  // The root of a 2 x 2 matrix: (C + sqrt(det C) 1)/sqrt(tr C + 2 sqrt(det C)).
  const double area = std::sqrt(q), trace = 2 + e.trace_minus_2(), scale = 1 / std::sqrt(trace + 2 * area);
  const double V[3] = {scale * (1 + 2 * e.e11 + area), scale * (1 + 2 * e.e22 + area), scale * e.g};
  // R = F V^-1.
  const Vec3 r1 = (1 / area) * (V[1] * e.f1 - V[2] * e.f2), r2 = (1 / area) * (V[0] * e.f2 - V[2] * e.f1);
  out.across[0] = r1;
  out.across[1] = r2;
  out.stretch = std::sqrt(0.5 * trace + std::sqrt(std::max(0.25 * trace * trace - q, 0.0)));
  const auto U = prestretch_at(at(face) * points(), t);
  const double own_area = area * (U[0] * U[1] - U[2] * U[2]);
  const double thinning = std::pow(own_area, -c_);
  out.J = own_area * thinning;
  const PlaneResponse w = plane(at(face) * points(), e, t, false);
  const double S[2][2] = {{w.S[0], w.S[2]}, {w.S[2], w.S[1]}}, v[2][2] = {{V[0], V[2]}, {V[2], V[1]}};
  double VSV[2][2] = {};
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j)
      for (std::size_t k = 0; k < 2; ++k)
        for (std::size_t l = 0; l < 2; ++l) VSV[i][j] += v[i][k] * S[k][l] * v[l][j];
  const double share = 1 / (area * thickness * thinning);
  out.cauchy[0] = share * VSV[0][0];
  out.cauchy[1] = share * VSV[1][1];
  out.cauchy[2] = share * VSV[0][1];
  return out;
}

}  // namespace isochor
