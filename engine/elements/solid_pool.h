// Stencils whose value depends on deformation gradients at points: F_q = sum_a x_a (x) B_qa. Tets, hexahedra
// and the patches of edge-smoothed tets differ only in how many nodes and points a stencil has.
#pragma once

#include "engine/elements/material.h"
#include "engine/system/pool.h"
#include "isochor/choices.h"

namespace isochor {

// Rest data of solid stencils. All stencils of a set have the same number of points.
struct SolidData {
  Lists nodes;
  int points = 1;
  std::vector<Vec3> gradient;  // B: for stencil s, point q: points * nodes.offset[s] + q * n + a  [1/m]
  std::vector<double> weight;  // rest volume of a point: points a stencil [m^3]
  int functions = 0;           // volume functions a stencil: integral of N_k Phi(J)
  std::vector<double> shape;   // N_k at the points: [q * functions + k], the same for every stencil
  std::vector<Index> cell;     // cell of the mesh that a stencil stands for (first one for patches)
  // Of patches, until their fields are gathered: all their cells, and the share of each in the patch.
  Lists patch_cells;
  std::vector<double> patch_share;
};

struct Growth;

class SolidPool : public StencilPool, public RememberingStencils {
 public:
  // `material` may be null: volume functions alone. Energies are integrated over the points.
  // The data may be those of other pools, of clones of a world or of the scene before a change.
  SolidPool(std::string name, std::shared_ptr<const SolidData> data, std::shared_ptr<const Material> material,
            VolumeStrain strain);

  std::string_view name() const override { return name_; }
  StencilShape shape() const override {
    return {.energy = material_ != nullptr, .functions = data_.functions};
  }
  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override;
  StencilFacets facets() const override;
  // What points keep, one a point, where the material remembers.
  int memory() const override { return data_.points * static_cast<int>(nodes_.count()); }
  void accept(const StencilRequest& request, std::span<double> memory) const override;
  double kept(const std::span<const double> memory, Index stencil, int point) const {
    return memory.empty() ? 0 : memory[at(stencil * data_.points + point)];
  }

  const SolidData& data() const { return data_; }
  // Rest volume of a stencil [m^3].
  double volume(Index stencil) const;
  // Mean of J - 1 over it.
  double mean_volume_strain(Index stencil, std::span<const Vec3> x, std::span<const Vec3> rest) const;
  // Null: the mesh is free of stress (engine/elements/grown_pool.h).
  virtual const Growth* growth() const { return nullptr; }
  // F at the points of a stencil.
  void deformation_gradient(Index stencil, int point, std::span<const Vec3> x, std::span<const Vec3> rest,
                            double F[9], double& volume_strain) const;

 private:
  struct Lane;
  void flush(const StencilRequest& request, const StencilSlots& slots, Lane* lanes, int count) const;
  // Multiplier of the volume strain at a point: the multipliers of the functions, interpolated.
  double strain_multiplier(const StencilRequest& request, const Lane& lane) const;
  void definite_hessian(const StencilRequest& request, const Lane* lanes, int count, const PointBatch& batch,
                        ResponseBatch& response) const;
  void add_bending_of_mean(const StencilRequest& request, const StencilSlots& slots) const;
  void write(const StencilRequest& request, const StencilSlots& slots, const Lane& lane, double psi,
             const double* P, const double* A) const;

 protected:
  // F that the energy is of at a point.
  virtual void elastic_gradient(const StencilRequest& request, Index stencil, int point, double F[9]) const;
  // What evaluate() adds to begins at zero.
  void clear(const StencilRequest& request, const StencilSlots& slots) const;

  std::string name_;
  std::shared_ptr<const Material> material_;
  VolumeStrain strain_;
  double looks_back_below_ = -std::numeric_limits<double>::infinity();
  bool remembers_ = false;
  std::shared_ptr<const SolidData> shared_;
  const SolidData& data_;  // of shared_
};

}  // namespace isochor
