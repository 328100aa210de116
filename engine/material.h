// A hyperelastic energy density, evaluated for several deformation gradients at once.
#pragma once

#include "engine/spectrum.h"

namespace isochor {

// Structure of arrays: component first, lane second. F is row-major, F[3 i + j] = dx_i/dX_j.
struct alignas(64) PointBatch {
  double F[9][kLanes];
  Index element[kLanes];  // for parameter fields: the material's own element number
};

// psi [Pa], P = dpsi/dF [Pa] and A = dP/dF [Pa] (lower triangle packed: A[i (i + 1) / 2 + j], j <= i).
struct alignas(64) ResponseBatch {
  double psi[kLanes];
  double P[9][kLanes];
  double A[45][kLanes];
};

class Material {
 public:
  virtual ~Material() = default;
  virtual std::string_view name() const = 0;
  // Exact derivatives up to `want`, all lanes. psi is +infinity where the energy has no value.
  virtual void evaluate(Want want, const PointBatch& points, ResponseBatch& response) const = 0;

  // A once more, as the sum of two parts that can be made definite:
  // the isotropic part in closed form in the frame of F (all zero where a lane has no value) ...
  virtual void spectrum(const PointBatch& points, const Svd3& svd, Spectrum& out) const = 0;
  // ... and what is not isotropic (fibers), added to response.A and made definite by the material itself.
  virtual void add_anisotropic(Definiteness policy, const PointBatch& points, ResponseBatch& response) const {
    (void)policy;
    (void)points;
    (void)response;
  }
};

}  // namespace isochor
