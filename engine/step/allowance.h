// What one solve may cost.
#pragma once

#include "engine/solve/saddle_point.h"
#include "isochor/options.h"

namespace isochor {

struct Allowance {
  int iterations = 0, factorizations = 0;
  // The last iterate is kept when that is used up.
  bool keep_unfinished = false;
  // Beyond these a solve must get somewhere; 0: as above.
  int patient_iterations = 0, patient_factorizations = 0;
  // Bodies in motion go on beyond all of these while that leads downhill.
  bool persistent = false;
};

SaddleOptions saddle_options(const WorldOptions& options, const Allowance& allowance);

}  // namespace isochor
