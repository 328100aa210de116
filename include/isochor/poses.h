// Poses of a rigid bone over time.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "isochor/export.h"
#include "isochor/types.h"

namespace isochor {

// Where a bone is at one time.
struct Pose {
  double t = 0;                                // [s]; statics: load factor
  Vec3 position{};                             // of the bone's own origin [m]
  std::array<double, 4> rotation{1, 0, 0, 0};  // unit quaternion w, x, y, z
};

// A bone over time: linear between the keyframes in position, at constant angular velocity in rotation
// (spherical interpolation, the shorter way round), at rest before the first and after the last. The first
// keyframe is the pose in which the bodies were meshed.
struct PoseTrack {
  std::vector<Pose> keys;  // times ascending
  std::string file = {};   // where they are read from; only scene files use it
};

ISOCHOR_API Pose pose_at(const PoseTrack& track, double t);
// Where a point that is fixed to the bone is at time t; `rest` is where it is at the first keyframe [m].
ISOCHOR_API Vec3 carried(const PoseTrack& track, double t, const Vec3& rest);

// The angle that the bone turns from t0 to t1 [rad], summed over its keyframes.
ISOCHOR_API double turned(const PoseTrack& track, double t0, double t1);

// Refuses tracks without keys, times that do not ascend, numbers that are not finite and quaternions far
// from unit length.
ISOCHOR_API Result<void> check_poses(const PoseTrack& track);

// Reads lines "t, x, y, z, qw, qx, qy, qz" in seconds and meters; a first line of names and lines that begin
// with # are skipped. Quaternions are normalized.
ISOCHOR_API Result<PoseTrack> read_poses(const std::string& path);

}  // namespace isochor
