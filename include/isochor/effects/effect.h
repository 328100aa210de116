// What every effect is to a host.
#pragma once

#include <memory>

namespace isochor {

class EffectSource;  // engine-side
// A constraint, load or support, made by the functions of <isochor/effects.h>. Resolved when the world is
// compiled.
using EffectPtr = std::shared_ptr<const EffectSource>;

}  // namespace isochor
