// Energies in principal stretches for several deformation gradients at once, as materials of the engine. Laws
// that are written for one gradient at a time use stretch_batch.h.
#pragma once

#include <limits>

#include "engine/elements/material.h"

namespace isochor {

// Derivatives over the principal stretches, see Spectrum; d: Psi_i.
struct StretchLanes {
  Lanes psi{}, d[3]{};
  Spectrum second{};
};

// No value, and no slope, where a stretch is next to zero or negative, or where the energy is beyond the
// range of numbers: powers of smaller stretches leave it, and no material gets there.
inline void keep_domain(const Lanes& smallest_stretch, StretchLanes& r) {
  constexpr double least = 1e-30;
  const LaneMask none =
      (smallest_stretch <= least) | ~(magnitude(r.psi) <= std::numeric_limits<double>::max());
  if (!any(none)) return;
  r.psi = none ? broadcast(std::numeric_limits<double>::infinity()) : r.psi;
  for (int i = 0; i < 3; ++i) {
    for (Lanes* v :
         {&r.d[i], &r.second.twist[i], &r.second.flip[i], &r.second.scaling[i], &r.second.scaling[3 + i]}) {
      *v = none ? Lanes{} : *v;
    }
  }
}

// `Law` has: StretchLanes respond(Want, const Lanes sigma[3]) const, pure; the stretches come in order.
template <class Law>
class StretchLanesMaterial final : public Material {
 public:
  StretchLanesMaterial(std::string_view name, Law law) : name_(name), law_(std::move(law)) {}
  std::string_view name() const override { return name_; }
  void describe(Fingerprint& f) const override { f.add(name_, law_); }

  void evaluate(Want want, const PointBatch& points, ResponseBatch& r) const override {
    Lanes F[9];
    for (int i = 0; i < 9; ++i) F[i] = load(points.F[i]);
    Svd3 svd;
    svd3(F, svd);
    const StretchLanes e = law_.respond(want, svd.sigma);
    store(e.psi, r.psi);
    if (want == Want::value) return;
    for (int i = 0; i < 3; ++i) {
      const Lanes u[3] = {svd.U[3 * i] * e.d[0], svd.U[3 * i + 1] * e.d[1], svd.U[3 * i + 2] * e.d[2]};
      for (int j = 0; j < 3; ++j) {
        store(u[0] * svd.V[3 * j] + u[1] * svd.V[3 * j + 1] + u[2] * svd.V[3 * j + 2], r.P[3 * i + j]);
      }
    }
    if (want == Want::gradient) return;
    Lanes A[45];
    assemble(svd, e.second, A);
    for (int i = 0; i < 45; ++i) store(A[i], r.A[i]);
  }
  void spectrum(const PointBatch&, const Svd3& svd, Spectrum& out) const override {
    out = law_.respond(Want::hessian, svd.sigma).second;
  }

 private:
  std::string_view name_;
  Law law_;
};

}  // namespace isochor
