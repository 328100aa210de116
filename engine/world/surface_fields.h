// Forces on surfaces as fields that can be looked at.
#pragma once

#include "engine/scene/builder.h"

namespace isochor {

// Fills BodyFields::node_contact_pressure and node_friction from what the effects exert on the body; leaves
// them empty where no effect is about its surface.
void add_surface_fields(std::span<const std::unique_ptr<EffectInstance>> effects, const GaugeContext& context,
                        const BodyData& body, BodyFields& fields);

}  // namespace isochor
