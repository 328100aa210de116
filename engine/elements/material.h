// A hyperelastic energy density, evaluated for several deformation gradients at once.
#pragma once

#include <limits>
#include <memory>

#include "engine/base/fingerprint.h"
#include "engine/math/spectrum.h"

namespace isochor {

// Structure of arrays: component first, lane second. F is row-major, F[3 i + j] = dx_i/dX_j.
struct alignas(64) PointBatch {
  double F[9][kLanes];
  Index element[kLanes];  // for parameter fields: the material's own element number
  double
      J_before[kLanes];  // det F when the increment began; set where Material::looks_back_below() asks for it
  double kept[kLanes];   // of the point, from the last increment that was accepted; set where
                         // Material::remembers(), zero at the start
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
  // Every constant of the law, and of each element where they vary.
  virtual void describe(Fingerprint& f) const = 0;
  // Exact derivatives up to `want`, all lanes. psi is +infinity where the energy has no value.
  virtual void evaluate(Want want, const PointBatch& points, ResponseBatch& response) const = 0;

  // Below this J evaluate() and spectrum() read points.J_before.
  virtual double looks_back_below() const { return -std::numeric_limits<double>::infinity(); }

  // True: evaluate() and spectrum() read points.kept, a number a point that keep() makes of the state that a
  // step is accepted with; it finds the one before in its place.
  virtual bool remembers() const { return false; }
  virtual void keep(const PointBatch& points, double* kept) const {
    (void)points;
    (void)kept;
  }

  // A once more, as the sum of two parts that can be made definite:
  // the isotropic part in closed form in the frame of F (all zero where a lane has no value) ...
  virtual void spectrum(const PointBatch& points, const Svd3& svd, Spectrum& out) const = 0;
  // ... and what is not isotropic (fibers), added to response.A and made definite by the material itself.
  virtual void add_anisotropic(Definiteness policy, const PointBatch& points, ResponseBatch& response) const {
    (void)policy;
    (void)points;
    (void)response;
  }

  // The same material with its fields gathered for the stencils of a pool: stencil s takes the mean over the
  // cells of its list, with weights that sum to one. Null where it has no fields; before, element numbers are
  // those of the cells of the mesh.
  virtual std::shared_ptr<const Material> gathered(const Lists& cells, std::span<const double> weight) const {
    (void)cells;
    (void)weight;
    return nullptr;
  }
};

}  // namespace isochor
