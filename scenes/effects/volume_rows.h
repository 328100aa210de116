// Volume rows of a body, as a scene says them.
#pragma once

#include "isochor/effects/volume.h"

namespace isochor {

// `none` leaves a body to its complete one-field energy, which locks near nu = 0.5.
struct VolumeRows {
  VolumeDef def;
  bool none = false;
};

}  // namespace isochor
