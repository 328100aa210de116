// Stresses of a sheet, for results.
#pragma once

#include "constraints/layer/membrane_pool.h"
#include "constraints/layer/shell_rows.h"
#include "engine/scene/builder.h"

namespace isochor {

// What the stresses of a shell are made of.
struct SheetRecovery {
  std::shared_ptr<const MembranePool> membrane;
  Bending bending;
  Index row_pool = -1;  // of its moments; -1: nothing bends
  double thickness = 0;
  bool solid = true;  // its bending is that of its thickness
};

struct SheetCell {
  std::array<double, 6> stress{};  // Cauchy, in the middle of the sheet: xx yy zz xy yz zx [Pa]
  double stretch = 1;              // the largest
  double J = 1;                    // of the sheet, its change of thickness included
  double largest = 0;              // equivalent stress over the thickness [Pa]
};

// By triangle. The stress of bending is 6 m / thickness^2, more on one side and less on the other.
std::vector<SheetCell> recover_sheet(const SheetRecovery& sheet, const GaugeContext& context);

}  // namespace isochor
