// The place of an effect that does not act now.
#pragma once

#include <string>

#include "isochor/effects/effect.h"
#include "isochor/export.h"

namespace isochor {

// Does nothing: no rows, no unknowns, no cost. World::replace() puts an effect in its place when that begins
// to act, and it in the place of the effect when that ends, so that ids and the order of effects (supports
// before the chambers that they close) stay what they are.
ISOCHOR_API EffectPtr idle(std::string name);

}  // namespace isochor
