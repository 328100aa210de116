// The energy of a neo-Hookean membrane in plane stress, for layers and shells.
#pragma once

#include <cmath>
#include <limits>

#include "constraints/layer/face_strain.h"

namespace isochor {

// A function of Green's strain of a face in its plane, and its derivatives by (e11, e22, 2 e12). Not finite:
// outside the domain.
struct PlaneResponse {
  double value = 0;  // per rest area
  double S[3] = {};
  double D[3][3] = {};  // filled where it is asked for
};

// Psi = mu/2 (I_3 - 3) + mu/(2 b) (J^(-2 b) - 1), b = nu/(1 - 2 nu), whose stress across the thickness
// vanishes at a stretch of area ratio^(-c), c = nu/(1 - nu). What is left per thickness is
// mu/2 (tr C - 2) + mu/(2 c) (q^(-c) - 1); nu = 0.5 is the incompressible membrane, c = 0 the limit
// -mu/2 log q.
class MembranePool : public FaceStrainPool {
 public:
  MembranePool(std::string name, std::size_t nodes_per_face, std::span<const Index> faces,
               std::span<const Vec3> rest, double mu_thickness, double poisson)
      : FaceStrainPool(std::move(name), Gives::energy, nodes_per_face, faces, rest),
        mu_(mu_thickness),
        c_(poisson / (1 - poisson)) {}

  // Stresses of a flat triangle, in the middle of the sheet.
  struct Stress {
    Vec3 across[2];         // directions in the plane of the face now: those of its frame at rest, turned
    double cauchy[3] = {};  // 11, 22, 12 in them [Pa]
    double stretch = 1;     // the largest, of the body
    double J = 1;           // of the sheet, its change of thickness included
  };
  // The frame of a triangle at rest.
  std::array<Vec3, 2> axes(Index face) const {
    return {frame(at(face) * points()).t1, frame(at(face) * points()).t2};
  }
  Stress stress(Index face, std::span<const Vec3> x, std::span<const Vec3> rest, double t,
                double thickness) const;

 protected:
  using PlaneStrain = Strain;
  // The energy at a point and time.
  virtual PlaneResponse plane(std::size_t point, const PlaneStrain& e, double t, bool hessian) const;
  // That of the membrane alone.
  PlaneResponse isotropic(const PlaneStrain& e, bool hessian) const;

  // Stretch from the sheet without stress to the body at rest: 11, 22, 12.
  virtual std::array<double, 3> prestretch_at(std::size_t point, double t) const {
    (void)point;
    (void)t;
    return {1, 1, 0};
  }

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
