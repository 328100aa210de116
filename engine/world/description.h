// What a host has said that a world holds, and what becomes of it.
#pragma once

#include "engine/scene/builder.h"
#include "isochor/effects/effect.h"
#include "isochor/options.h"

namespace isochor {

struct Description {
  Builder builder;                 // with the bodies
  Slots places;                    // of effects
  std::vector<EffectPtr> sources;  // by place, null where there is none
  std::vector<Index> order;        // places of effects, as they were added
};

// From what a host said to the parts of a system and the live parts of its effects, by place.
struct BuiltParts {
  SystemParts parts;
  std::vector<std::unique_ptr<EffectInstance>> instances;
  std::vector<std::vector<HeldDirection>> held_by;
};
Result<BuiltParts> build_parts(Description& said, const WorldOptions& options);

// The mass that gravity acts on, one a node [kg].
std::vector<double> gravity_mass(const Builder& builder, const SystemParts& parts,
                                 const WorldOptions& options);

}  // namespace isochor
