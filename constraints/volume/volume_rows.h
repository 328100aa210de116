// Rows over the volume functions of a solid: per element, per node, whole set. Mixed pressures are their
// multipliers.
#pragma once

#include <optional>

#include "engine/elements/material_model.h"
#include "engine/elements/solid_pool.h"

namespace isochor {

// What the rows of one region are made from.
struct VolumeRegion {
  std::string name;  // for reports
  Index stencil_pool = -1;
  const SolidPool* pool = nullptr;
  VolumeStrain strain = VolumeStrain::linear;
  int corners = 4;           // the first `corners` nodes of a stencil carry the linear pressure
  double inverse_bulk = 0;   // 1/kappa [1/Pa], of the softest cell; 0: hard rows
  double shear_modulus = 1;  // mu [Pa], for the row metric and the stabilization
  const MaterialModel* material = nullptr;  // where its constants vary from cell to cell
  std::vector<double> own_inverse_bulk;     // 1/kappa of each stencil, where several regions are one [1/Pa]

  // The same for one stencil. Without a bulk compliance in the region (hard rows) no cell has one.
  double inverse_bulk_of(Index stencil) const {
    if (!own_inverse_bulk.empty()) return own_inverse_bulk[at(stencil)];
    return material && inverse_bulk > 0 ? material->inverse_bulk_of(pool->data().cell[at(stencil)])
                                        : inverse_bulk;
  }
  double shear_modulus_of(Index stencil) const {
    return material ? shear_modulus * material->stiffness_factor(pool->data().cell[at(stencil)])
                    : shear_modulus;
  }
};

// Base of the family: targets are zero, the volume at rest.
class VolumeRowPool final : public RowPool, public SharedCompliance {
 public:
  explicit VolumeRowPool(VolumeRegion region) : region_(std::move(region)) {}
  std::string_view name() const override { return region_.name; }
  RowFacets facets() const override { return {.shared = this}; }
  std::vector<ComplianceShare> compliance_shares() const override;

  // Rows at nodes: with the stabilization that they have.
  void set_nodal(double tau) { nodal_ = tau; }
  // Row sums on the diagonal. Those of the stabilization are zero.
  void lump();

 private:
  VolumeRegion region_;
  std::optional<double> nodal_;
  bool lumped_ = false;
};

// One row an element: phi_e = integral of Phi over the element, C = V/kappa.
std::shared_ptr<RowPool> element_volume_rows(const VolumeRegion& region);

// One row a node of the region: phi_i = integral of N_i Phi with N_i linear (Frâncu et al. 2021, eq. for the
// mixed P1-P1 element). C = M_p/kappa with the consistent mass matrix M_p, plus the polynomial-projection
// stabilization (tau/mu) (M_e - m m^T/V), m_k the integral of N_k (V/4 on a tet), of Dohrmann & Bochev 2004
// when tau > 0; its rows sum to zero, so the total volume is not affected. `corner_nodes` returns the global
// nodes the rows stand for.
std::shared_ptr<VolumeRowPool> nodal_volume_rows(const VolumeRegion& region, double tau,
                                                 std::vector<Index>* corner_nodes = nullptr);

// One row over all stencils of the region: phi = volume integral of Phi, C = V/kappa.
std::shared_ptr<RowPool> total_volume_row(const VolumeRegion& region);

// Sets of stencils that may overlap, one row each. `compliance` scales 1/kappa of each; a set of infinite
// compliance gets no row.
struct VolumeZones {
  std::vector<std::vector<Index>> stencils;  // ascending
  std::vector<double> compliance;
  std::vector<std::vector<double>> weight;  // of each stencil in its zone, 0 to 1; empty: all 1
};

// Its compliance is zero, whatever the mesh.
bool is_hard_zone(const VolumeRegion& region, const VolumeZones& zones, std::size_t zone);

// Hard zones: phi_z = sum of weight times the integrals of Phi over the zone. Compliant ones share the
// stencils that they have in common: each counts its weight over the sum of the weights of all compliant
// zones there (1/n_e of it among n_e zones of weight 1), and C = sum of share V_e/kappa. So a uniform change
// of volume meets the bulk modulus kappa and a uniform pressure, however zones overlap.
std::shared_ptr<RowPool> zone_volume_rows(const VolumeRegion& region, const VolumeZones& zones);

// The zones of all stencils within `rings` rings around each corner node; equal ones once.
VolumeZones ring_zones(const VolumeRegion& region, int rings);

}  // namespace isochor
