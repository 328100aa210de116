// Refuses what a body or an analysis says that contradicts itself; messages start with `where`, the place.
#pragma once

#include "scenes/scene.h"

namespace isochor {

// Without a look at its mesh.
Result<void> check_body(const std::string& where, const SceneBody& body);
Result<void> check_analysis(const std::string& where, const AnalysisDef& analysis);

}  // namespace isochor
