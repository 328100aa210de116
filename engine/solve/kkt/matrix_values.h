// What one matrix is made of, besides the last evaluation of the assembly.
#pragma once

#include "engine/system/system.h"

namespace isochor {

class UnsymmetricPart;

struct MatrixValues {
  double mass_scale = 0;                  // [1/s^2]
  double shift = 0;                       // of the displacement block, relative to each node's stiffness
  std::span<const double> stiffness;      // reference of every node [N/m]
  std::span<const double> tangent;        // one for each System::compliance() entry; read where laws are
  std::span<const std::uint8_t> clamped;  // rows held at a bound; empty: none
  double trace = 0;  // compliance added to the matrix alone, relative; the equations solved are others
  // Makes the matrix unsymmetric, for the solver given to Kkt::take_unsymmetric(); rows that have a share in
  // it are kept, and none are bordered or dual.
  const UnsymmetricPart* unsymmetric = nullptr;

  bool held(Index row) const { return !clamped.empty() && clamped[at(row)] != 0; }
  // Of an entry of System::compliance(): constant, or the tangent of a law.
  double compliance(const System& system, std::size_t entry) const {
    for (const LawPlace& law : system.laws()) {
      const std::size_t count = system.parts().row_pools[at(law.row_pool)]->compliance.size();
      if (entry >= law.first_entry && entry < law.first_entry + count) return tangent[entry];
    }
    return system.compliance()[entry].value;
  }
};

}  // namespace isochor
