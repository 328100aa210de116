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
};

}  // namespace isochor
