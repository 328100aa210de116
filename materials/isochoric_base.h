// What asks for a law whose energy a change of size alone leaves where it is.
#pragma once

#include "engine/elements/material_model.h"

namespace isochor {

// Of the energy without its volume part.
bool is_isochoric(const Material& energy);

}  // namespace isochor
