// Free rigid bodies as contacts find them.
#pragma once

#include <map>

#include "constraints/contact/rigid/contact_frame.h"
#include "engine/scene/builder.h"

namespace isochor {

// Shared between effects under kRigidBodies.
struct RigidBodies {
  std::map<std::string, RigidShape> by_name;
};
inline constexpr const char* kRigidBodies = "rigid bodies";

// The shape in its principal axes about its center of mass: as it is, but for meshes and distance fields.
Obstacle principal_form(const Obstacle& shape);

Result<RigidShape> find_rigid(Builder& builder, const std::string& name, const std::string& who);

// Points by which a shape touches others, in its own axes, and how far they keep away.
struct TouchPoint {
  Vec3 own{};
  double offset = 0;
};
std::vector<TouchPoint> touch_points(const Obstacle& shape);

}  // namespace isochor
