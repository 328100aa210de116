// Time schemes a world can use.
#pragma once

#include "isochor/world.h"

namespace isochor {

// No inertia: `time` is the load factor.
SchemePtr statics();
// First order, unconditionally stable, dissipative.
SchemePtr implicit_euler();

}  // namespace isochor
