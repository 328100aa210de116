// Reports of steps as C sees them.
#pragma once

#include "handles.h"

namespace isochor::c {

// Texts stay those of `from`.
void show(const StepReport& from, iso_report& out);

}  // namespace isochor::c
