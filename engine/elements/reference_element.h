// Reference elements: shape functions at quadrature points, from which rest data of solid stencils is
// computed once.
#pragma once

#include "engine/elements/solid_pool.h"

namespace isochor {

// Another element joins by filling in one more of these.
struct ReferenceElement {
  int nodes = 0;
  int points = 0;
  std::vector<double> weight;        // points; sums to the volume of the reference element
  std::vector<Vec3> shape_gradient;  // [q * nodes + a] dN_a/dxi
  std::vector<double> shape;         // [q * nodes + a] N_a
  std::vector<double> corner_shape;  // [q * corners + k] linear functions of the corners (pressure space)
  int corners = 0;
};

const ReferenceElement& tet4_element();   // one point
const ReferenceElement& tet10_element();  // 14 points, exact to degree 5 (Walkington 2000)
const ReferenceElement&
hex8_element();  // 2 x 2 x 2 Gauss points on [-1, 1]^3, exact to degree 3 in each direction

const ReferenceElement& tri3_element();  // of thin bodies: corners, and no points in a volume

// Which volume functions a stencil offers.
enum class VolumeFunctions : std::uint8_t {
  none,
  constant,  // one a stencil: integral of Phi
  corners,   // one a corner: integral of N_k Phi
};

// Rest data of the cells given (indices into `cells`, element.nodes node indices each). Cells whose map is
// not invertible at a point are an error that names the first of them.
Result<SolidData> solid_data(const ReferenceElement& element, std::span<const Vec3> rest,
                             std::span<const Index> cell_nodes, std::span<const Index> cells,
                             VolumeFunctions functions);

// Patches of edge-smoothed tets: for every edge of the given cells the volume-weighted mean gradient over the
// tets around it, each tet giving a sixth of its volume to each of its edges (Liu, Nguyen-Thoi & Lam 2009;
// Onishi & Amaya 2014). Pass the cells of one region at a time, so that no patch spans two materials.
Result<SolidData> edge_patch_data(std::span<const Vec3> rest, std::span<const Index> cell_nodes,
                                  std::span<const Index> cells);

// Lumped mass of the cells, added to `mass` [kg]: positive at every node of a Tet10 too (diagonal scaling of
// the consistent matrix; Hinton, Rock & Zienkiewicz 1976).
void add_lumped_mass(const ReferenceElement& element, std::span<const Vec3> rest,
                     std::span<const Index> cell_nodes, std::span<const Index> cells, double density,
                     std::span<double> mass);

// Lower triangle of the consistent mass matrix of the cells, appended to `mass`: integrals of density N_a
// N_b.
void add_consistent_mass(const ReferenceElement& element, std::span<const Vec3> rest,
                         std::span<const Index> cell_nodes, std::span<const Index> cells, double density,
                         std::vector<MassEntry>& mass);

// Integral of N_a over each cell, added to `volume` [m^3]: what a body force is shared out by (consistent).
void add_nodal_volume(const ReferenceElement& element, std::span<const Vec3> rest,
                      std::span<const Index> cell_nodes, std::span<const Index> cells, double density,
                      std::span<double> volume);

}  // namespace isochor
