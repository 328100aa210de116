// A hyperelastic energy density, evaluated for several deformation gradients at once.
#pragma once

#include "engine/base.h"

namespace isochor {

inline constexpr int kLanes = 8;  // deformation gradients per batch

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
};

}  // namespace isochor
