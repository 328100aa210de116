// Where a support or an obstacle is over time: the track of its definition until a host sets a pose, to which
// it then moves within one increment.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "isochor/export.h"
#include "isochor/poses.h"

namespace isochor {

class ISOCHOR_API LivePose {
 public:
  // A track without keyframes stands for a pose at the origin that never changes.
  explicit LivePose(PoseTrack said);
  // The track that is valid now. Its first keyframe is the pose in which the bodies were meshed.
  const PoseTrack& track() const { return held_ ? set_ : said_; }
  // Whether a host has set it, and whether what was set is valid by now.
  bool set_by_host() const { return held_ || pending_; }
  bool held() const { return held_; }
  void forget() {
    held_ = false;
    pending_.reset();
  }
  void set(const Pose& pose) { pending_ = pose; }
  // Announces the increment [t0, t1]: what is pending is reached over it.
  void begin(double t0, double t1);
  void save(std::vector<double>& out) const;
  void load(std::span<const double>& in);
  // Takes the numbers of one pose off a list; false where they are none.
  static bool take(std::span<const double>& in);

 private:
  void hold(const Pose& from, const Pose& to);

  PoseTrack said_, set_;
  bool held_ = false;
  std::optional<Pose> pending_;
};

}  // namespace isochor
