// Rows that keep volume: by node, element, ring, zone or body.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "isochor/choices.h"
#include "isochor/effects/effect.h"
#include "isochor/export.h"
#include "isochor/ids.h"
#include "isochor/painted.h"

namespace isochor {

enum class VolumeSpace : std::uint8_t { node, element, body, ring, zone };

// A set of cells with one row; zones may overlap. What fits any of the criteria is in it.
struct VolumeZone {
  std::string name;
  std::vector<std::string> regions;
  std::vector<Index> cells;                // of the body's mesh
  std::vector<std::array<Vec3, 2>> boxes;  // lower and upper corner [m]: cells with their center inside
  // A field of the mesh with weights from 0 to 1 painted on its surface; cells get the weights of the points
  // of the surface that they are projected to (isochor/painted.h). Painted zones share cells by weight.
  std::string field;
  // Times 1/kappa: 0 is a hard zone, infinity leaves the row out.
  double compliance = 1;
};

struct VolumeDef {
  std::string name = "volume";
  BodyId body{};
  VolumeSpace space = VolumeSpace::node;
  VolumeStrain strain = VolumeStrain::by_law;
  // Regions it covers; empty: all. Rows are split at interfaces between regions, where the pressure jumps.
  std::vector<std::string> regions;
  // Space ring: one row over the cells within so many rings around each node, 1 those that touch it.
  int rings = 1;
  std::vector<VolumeZone> zones;  // space zone
  // Of painted zones: what becomes of cells that nothing was painted on, and the surfaces that were painted
  // (empty: all of the boundary).
  UnpaintedCells unpainted = UnpaintedCells::none;
  std::vector<std::string> painted_surfaces;
  // Spaces body and zone: rows over cells of several regions. Each cell adds its own volume/kappa to the
  // compliance of its row, and the pressure is the same in all of them. False: `body` gives one row a region,
  // and zones over several are refused.
  bool across_regions = false;
  // Dohrmann-Bochev stabilization of nodal rows on linear tets; ignored where inf-sup holds. 0: off.
  double stabilization = 1;
  // No bulk compliance whatever the material says (nodal rows keep their stabilization, which leaves totals
  // alone).
  bool hard = false;
  // True: these rows carry the bulk modulus and the elements keep only the distortional energy. False: the
  // rows come on top of other rows or of the complete one-field energy.
  bool carries_bulk = true;
  // How the linear systems take the rows; refused with the reason where it cannot be (docs/solver.md).
  RowTreatment treatment = RowTreatment::automatic;
  // Nodal rows: the compliance M_p/kappa lumped to its row sums, without stabilization, so that the rows can
  // be condensed. Another model than the consistent one; not for hard rows.
  bool lumped_compliance = false;
};
ISOCHOR_API EffectPtr volume(VolumeDef def);

}  // namespace isochor
