// Parts of a world from the keys of scene files, as JSON texts.
#pragma once

#include "interop.h"
#include "isochor/world.h"
#include "scenes/parts_by_keys.h"

namespace isochor::python {

// What keys of effects mean in a world.
struct KeyMeaning {
  AnalysisType analysis = AnalysisType::dynamics;
  Vec3 gravity{};
  Curve gravity_curve = Curve::constant(1);

  // With the names that are in the world now.
  PartContext in(const World& world) const;
};

// The keys of "analysis", with "scheme" one word for statics, too.
WorldOptions options_from(const std::string& keys, KeyMeaning& meaning);

}  // namespace isochor::python
