#include "engine/scene/live_pose.h"

#include <cmath>

namespace isochor {

namespace {

constexpr std::size_t kPose = 8;                     // numbers: time, position, rotation
constexpr std::size_t kNumbers = 1 + 3 * kPose + 1;  // held, from, to, pending

void put(const Pose& p, std::vector<double>& out) {
  out.insert(out.end(), {p.t, p.position.x, p.position.y, p.position.z});
  out.insert(out.end(), p.rotation.begin(), p.rotation.end());
}

Pose pose_from(std::span<const double> in) {
  return {in[0], {in[1], in[2], in[3]}, {in[4], in[5], in[6], in[7]}};
}

}  // namespace

LivePose::LivePose(PoseTrack said) : said_(std::move(said)) {}

// Behind the pose at rest, which comes before everything.
void LivePose::hold(const Pose& from, const Pose& to) {
  Pose rest = said_.keys.empty() ? Pose{} : said_.keys.front();
  rest.t = from.t - 1;
  set_.keys = {rest, from};
  if (to.t > from.t) set_.keys.push_back(to);
  held_ = true;
}

void LivePose::begin(double t0, double t1) {
  if (!pending_) return;
  Pose from = pose_at(track(), t0), to = *pending_;
  from.t = t0;
  to.t = t1;
  // Dynamics: the pose is reached at the end of the increment, however the way there is cut.
  if (!(t1 > t0)) from = to;
  hold(from, to);
  pending_.reset();
}

void LivePose::save(std::vector<double>& out) const {
  out.push_back(held_ ? 1.0 : 0.0);
  put(held_ ? set_.keys[1] : Pose{}, out);
  put(held_ ? set_.keys.back() : Pose{}, out);
  out.push_back(pending_ ? 1.0 : 0.0);
  put(pending_.value_or(Pose{}), out);
}

bool LivePose::take(std::span<const double>& in) {
  const auto is_flag = [](double v) { return v == 0 || v == 1; };
  if (in.size() < kNumbers || !is_flag(in[0]) || !is_flag(in[1 + 2 * kPose])) return false;
  for (const std::size_t first : {std::size_t{1}, 1 + kPose, 2 + 2 * kPose}) {
    const Pose p = pose_from(in.subspan(first));
    double size = 0;
    for (const double q : p.rotation) size += q * q;
    if (std::abs(size - 1) > 1e-2) return false;
  }
  in = in.subspan(kNumbers);
  return true;
}

void LivePose::load(std::span<const double>& in) {
  held_ = false;
  if (in[0] != 0) hold(pose_from(in.subspan(1)), pose_from(in.subspan(1 + kPose)));
  pending_.reset();
  if (in[1 + 2 * kPose] != 0) pending_ = pose_from(in.subspan(2 + 2 * kPose));
  in = in.subspan(kNumbers);
}

}  // namespace isochor
