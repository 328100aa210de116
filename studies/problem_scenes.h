// Scenes that only studies need.
#pragma once

#include "scenes/library.h"

namespace isochor::studies {

// A cube of 0.2 m on a rough table under a dead pressure of 15 kPa on its top (E = 66 kPa, nu = 0.4999; the
// case of Francu et al. 2021, figure 12): a quarter of it.
SceneDef compressed_block(const SceneVariant& variant);

// The cantilever, horizontal and at rest, that gravity takes hold of at once: 0.25 s of its first swing.
inline constexpr double kSwingDuration = 0.25;  // [s]
SceneDef swing(const SceneVariant& variant);

}  // namespace isochor::studies
