// Poses of bones over time.
#include "isochor/poses.h"

#include <cmath>

#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::File file(".csv");
  const auto track = isochor::read_poses(file.write(data, size));
  if (!track) {
    fuzz::require_message(track.error());
    return 0;
  }
  fuzz::require(isochor::check_poses(track.value()).ok(), "poses that were read do not pass their own check");
  const isochor::Pose pose = isochor::pose_at(track.value(), 0.5);
  fuzz::require(std::isfinite(pose.rotation[0]), "a rotation is no finite number");
  return 0;
}
