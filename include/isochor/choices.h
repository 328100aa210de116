// Choices that hosts make and the engine acts on.
#pragma once

#include <cstdint>

namespace isochor {

// Who solves the linear systems. All but `iterative` factor the matrix; that one iterates, with memory linear
// in the mesh (docs/solver.md). What a build does not have is refused when the world is compiled.
enum class Solver : std::uint8_t {
  automatic,
  mumps,
  cholmod,
  eigen,
  iterative,
  multifrontal,       // our own, in single precision where that is good enough
  cholmod_supernodal  // positive definite matrices only: no rows in the matrix. GPL, off by default
};

// The strain that volume rows measure.
enum class VolumeStrain : std::uint8_t {
  linear,       // J - 1
  logarithmic,  // log J; its multiplier is J times the pressure
  mixed,        // of the sign of J - 1, its square (J^2 - 1 - 2 log J)/2
  // The same of the mean of J over a cell, which is what three-field elements of other codes take; the two
  // differ where J varies within a cell. Not for rows at nodes.
  mean_logarithmic,
  mean_mixed,
  // The one whose square the law of the material has as U(J), J - 1 where it names none; of the mean for
  // rows of the space element.
  by_law,
};

}  // namespace isochor
