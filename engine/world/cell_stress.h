// The Cauchy stress of one cell, as recover_fields() has it of all: for outputs, and for how it changes with
// the unknowns around the cell.
#pragma once

#include "engine/world/watched.h"

namespace isochor {

// A patch around an edge that a cell takes a share of its stress from.
struct PatchOfCell {
  Index stencil = -1;  // of the region's energy
  double share = 1;
};

class CellStress {
 public:
  // Of a cell of a body that is not thin.
  CellStress(const BodyData& body, const SystemParts& parts, Index cell);

  Stress whole(const RecoveryInput& in) const;
  Stress of_energy(const RecoveryInput& in) const;            // without the pressure of rows
  double of_rows(const RecoveryInput& in) const;              // the pressure, linear in multipliers
  const std::vector<Index>& nodes() const { return nodes_; }  // of the scene, that it depends on
  double size() const;                                        // [m]
  const RegionData& region() const { return *region_; }
  const std::vector<PatchOfCell>& patches() const { return patches_; }  // empty: the cell has its own energy
  // Multipliers that the pressure depends on: functions `first` to `first + count` of a stencil pool.
  struct Functions {
    Index pool = -1, first = 0, count = 0;
  };
  std::vector<Functions> functions(const RecoveryInput& in) const;

 private:
  void find_patches(const BodyData& body, const SystemParts& parts);

  const RegionData* region_ = nullptr;
  Index cell_ = -1, local_ = -1;
  std::shared_ptr<const SolidPool> pool_;  // of the cell alone
  std::vector<PatchOfCell> patches_;
  std::vector<Index> nodes_;
};

}  // namespace isochor
