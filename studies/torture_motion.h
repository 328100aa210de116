// Cases of the torture suite that are about motion: see torture_cases.cpp.
#pragma once

#include "studies/torture.h"

namespace isochor::studies {

// A ball that hits the floor with 2 m/s times the load, on a mesh of 155 or of 1,175 nodes.
TortureResult ball_coarse(const TortureSettings& settings);
TortureResult ball_fine(const TortureSettings& settings);
// A free bar that swings for 1,000 steps with a scheme that damps nothing. Its slowest vibration takes 0.14
// s; steps of 8 ms leave most vibrations unresolved, and what damps nothing then gains energy.
TortureResult swing(const TortureSettings& settings);

}  // namespace isochor::studies
