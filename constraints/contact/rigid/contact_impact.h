// What points against a rigid shape do in an impact.
#pragma once

#include "constraints/contact/rigid/rigid_geometry.h"

namespace isochor {

// Rate of the gap [m/s] when an increment begins, at velocities v + jump; obstacles move as they will until
// it ends.
double gap_rate(const RigidGeometry& geometry, Index s, const ImpactStart& start, const ContactFrame& frame,
                const ContactFrame& later, std::span<const Vec3> jump);

// What a unit impulse along the normal does: velocities of the nodes of the stencil, and the rate of the gap.
struct Impact {
  std::array<Vec3, 8> velocity{};  // [m/s over N s]
  double mobility = 0;             // [1/kg]
};
Impact impact(const RigidGeometry& geometry, Index s, const ImpactStart& start, const ContactFrame& frame);

}  // namespace isochor
