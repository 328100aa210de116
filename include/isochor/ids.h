// Names of what a world holds, as World hands them out.
#pragma once

#include "isochor/types.h"

namespace isochor {

enum class BodyId : Index {};
enum class EffectId : Index {};

}  // namespace isochor
