// Which cells a zone of volume rows holds, and the rows over them.
#pragma once

#include "constraints/volume/volume_rows.h"
#include "engine/scene/builder.h"
#include "isochor/effects/volume.h"

namespace isochor {

// What the rows of `def` measure in a material.
VolumeStrain strain_in(const VolumeDef& def, const MaterialModel& material);

// The regions as one, with a stencil pool of its own that knows where kappa differs. Without a pool where no
// region has a bulk modulus for rows to carry.
Result<VolumeRegion> region_across(Builder& builder, const VolumeDef& def,
                                   std::span<const std::size_t> regions);

// Rows of the zones of `def` over the regions given. Hard zones make a pool of their own, which checks of
// hard rows look at as a whole.
Result<std::vector<std::shared_ptr<RowPool>>> zone_rows(Builder& builder, const VolumeDef& def,
                                                        const std::vector<VolumeRegion>& regions);

}  // namespace isochor
