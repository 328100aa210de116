// The energy of a neo-Hookean membrane in plane stress, for layers and shells.
#pragma once

#include <cmath>
#include <limits>

#include "constraints/layer/face_strain.h"

namespace isochor {

// Psi = mu/2 (I_3 - 3) + mu/(2 b) (J^(-2 b) - 1), b = nu/(1 - 2 nu), whose stress across the thickness
// vanishes at a stretch of area ratio^(-c), c = nu/(1 - nu). What is left per thickness is
// mu/2 (tr C - 2) + mu/(2 c) (q^(-c) - 1); nu = 0.5 is the incompressible membrane, c = 0 the limit
// -mu/2 log q.
class MembranePool final : public FaceStrainPool {
 public:
  MembranePool(std::string name, std::size_t nodes_per_face, std::span<const Index> faces,
               std::span<const Vec3> rest, double mu_thickness, double poisson)
      : FaceStrainPool(std::move(name), Gives::energy, nodes_per_face, faces, rest),
        mu_(mu_thickness),
        c_(poisson / (1 - poisson)) {}

 protected:
  FaceResponse respond(double trace_minus_2, double d) const override {
    FaceResponse w;
    w.value = std::numeric_limits<double>::infinity();
    if (!(d > -1)) return w;
    const double log_q = std::log1p(d), volumetric = c_ > 0 ? std::expm1(-c_ * log_q) / c_ : -log_q;
    const double value = 0.5 * mu_ * (trace_minus_2 + volumetric);
    const double q = -0.5 * mu_ * std::exp(-(c_ + 1) * log_q);
    const double qq = 0.5 * mu_ * (c_ + 1) * std::exp(-(c_ + 2) * log_q);
    if (!std::isfinite(value) || !std::isfinite(q) || !std::isfinite(qq)) return w;
    w.value = value;
    w.I = 0.5 * mu_;
    w.q = q;
    w.qq = qq;
    return w;
  }

 private:
  double mu_;  // shear modulus times thickness [N/m]
  double c_;
};

}  // namespace isochor
