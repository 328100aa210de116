// What two systems have in common: who is where, whatever the numbers.
#pragma once

#include "engine/system/system.h"

namespace isochor {

// Whether the parts have the same stencils on the same nodes, the same rows over the same functions with the
// same weights, and hold the same coordinates, so that all tables of their systems are the same.
bool same_structure(const SystemParts& a, const SystemParts& b);

bool same_treatment(const TreatedRows& a, const TreatedRows& b);

}  // namespace isochor
