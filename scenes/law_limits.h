// Laws that have no value beyond some stretch: what a run that stopped next to it should say.
#pragma once

#include <string>

#include "scenes/scene.h"

namespace isochor {

// One sentence about the first body whose cells are next to the limit of its law of Gent; empty: none is.
std::string law_limit_reached(const SceneDef& scene, const BuiltScene& built);

}  // namespace isochor
