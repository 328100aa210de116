// A solid whose stress-free state is not that of its mesh (engine/elements/growth.h).
#pragma once

#include "engine/elements/growth.h"
#include "engine/elements/solid_pool.h"

namespace isochor {

// Energies are J_g psi(F_e): what has grown is of the same material, and Cauchy's stress is that of F_e.
// Volume functions are the integrals of N_k sqrt(J_g) Phi(J_e). With the root, a compliance in proportion to
// 1/kappa makes the volume part J_g kappa Phi^2/2 whatever J_g is, and so is a stabilization in proportion to
// the volume as it grows; multipliers are the pressure times sqrt(J_g).
//
// deformation_gradient() stays that of the mesh, F.
class GrownPool final : public SolidPool {
 public:
  // `growth`: gathered for the stencils.
  GrownPool(std::string name, std::shared_ptr<const SolidData> data, std::shared_ptr<const Material> material,
            VolumeStrain strain, std::shared_ptr<const Growth> growth)
      : SolidPool(std::move(name), std::move(data), std::move(material), strain),
        growth_(std::move(growth)) {}

  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override;
  const Growth* growth() const override { return growth_.get(); }

 private:
  void elastic_gradient(const StencilRequest& request, Index stencil, int point, double F[9]) const override;

  struct Lane;
  void flush(const StencilRequest& request, const StencilSlots& slots, const Lane* lanes, int count) const;
  void definite_hessian(const StencilRequest& request, const Lane* lanes, int count, const PointBatch& batch,
                        ResponseBatch& response) const;
  void write(const StencilRequest& request, const StencilSlots& slots, const Lane& lane, double psi,
             const double* P, const double* A) const;
  // How the volume strain of the mean of J_e bends.
  void add_bending(const StencilRequest& request, const StencilSlots& slots, Index stencil,
                   const GrownState& grown) const;
  double grown_mean(Index stencil, const GrownState& grown, const StencilRequest& request) const;

  std::shared_ptr<const Growth> growth_;
};

}  // namespace isochor
