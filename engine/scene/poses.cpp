#include "isochor/poses.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "engine/base/text.h"

namespace isochor {

namespace {

using Quaternion = std::array<double, 4>;

double inner(const Quaternion& a, const Quaternion& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

Quaternion unit(Quaternion q) {
  const double size = std::sqrt(inner(q, q));
  for (double& c : q) c /= size;
  return q;
}

Quaternion slerp(const Quaternion& a, Quaternion b, double s) {
  double cosine = inner(a, b);
  if (cosine < 0) {  // q and -q are one rotation: take the shorter way
    cosine = -cosine;
    for (double& c : b) c = -c;
  }
  // Nearly the same rotation: the chord is as good as the arc, and does not divide by zero.
  double from = 1 - s, to = s;
  if (cosine < 1 - 1e-12) {
    const double angle = std::acos(cosine), sine = std::sin(angle);
    from = std::sin((1 - s) * angle) / sine;
    to = std::sin(s * angle) / sine;
  }
  Quaternion q{};
  for (std::size_t k = 0; k < 4; ++k) q[k] = from * a[k] + to * b[k];
  return unit(q);
}

Vec3 rotated(const Quaternion& q, const Vec3& v) {
  const Vec3 axis{q[1], q[2], q[3]};
  const Vec3 t = 2.0 * cross(axis, v);
  return v + q[0] * t + cross(axis, t);
}

Quaternion inverse(const Quaternion& q) {
  return {q[0], -q[1], -q[2], -q[3]};
}

}  // namespace

Pose pose_at(const PoseTrack& track, double t) {
  const auto& keys = track.keys;
  if (keys.empty()) return {};
  if (t <= keys.front().t) return keys.front();
  if (t >= keys.back().t) return keys.back();
  const auto after =
      std::upper_bound(keys.begin(), keys.end(), t, [](double v, const Pose& p) { return v < p.t; });
  const Pose &a = *(after - 1), &b = *after;
  const double s = (t - a.t) / (b.t - a.t);
  return {t, a.position + s * (b.position - a.position), slerp(unit(a.rotation), unit(b.rotation), s)};
}

double turned(const PoseTrack& track, double t0, double t1) {
  const auto& keys = track.keys;
  double sum = 0;
  for (std::size_t k = 1; k < keys.size(); ++k) {
    const double from = std::max(t0, keys[k - 1].t), to = std::min(t1, keys[k].t);
    if (!(to > from)) continue;
    const double cosine = std::abs(inner(unit(keys[k - 1].rotation), unit(keys[k].rotation)));
    sum += 2 * std::acos(std::min(1.0, cosine)) * (to - from) / (keys[k].t - keys[k - 1].t);
  }
  return sum;
}

Vec3 carried(const PoseTrack& track, double t, const Vec3& rest) {
  if (track.keys.empty() || t <= track.keys.front().t) return rest;
  const Pose& first = track.keys.front();
  const Pose now = pose_at(track, t);
  return now.position +
         rotated(unit(now.rotation), rotated(inverse(unit(first.rotation)), rest - first.position));
}

Result<void> check_poses(const PoseTrack& track) {
  if (track.keys.empty()) return Error{"it has no keyframe; give at least one pose"};
  for (std::size_t i = 0; i < track.keys.size(); ++i) {
    const Pose& p = track.keys[i];
    const std::string where = "keyframe " + std::to_string(i + 1) + ": ";
    const double size = std::sqrt(inner(p.rotation, p.rotation));
    if (!std::isfinite(p.t) || !std::isfinite(dot(p.position, p.position)) || !std::isfinite(size)) {
      return Error{where + "a number is not finite; give time, position and quaternion as plain numbers"};
    }
    if (std::abs(size - 1) > 1e-3) {
      return Error{where + "its quaternion has length " + number(size) +
                   "; a rotation has length 1, in the order w, x, y, z"};
    }
    if (i > 0 && !(p.t > track.keys[i - 1].t)) {
      return Error{where + "time " + number(p.t) + " does not come after " + number(track.keys[i - 1].t) +
                   "; list keyframes by ascending time"};
    }
  }
  return {};
}

Result<PoseTrack> read_poses(const std::string& path) {
  std::ifstream file(path);
  if (!file) return Error{path + ": cannot be read; check the name of the pose file"};
  PoseTrack track;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.find_first_not_of(" \t") == std::string::npos || line[0] == '#') continue;
    std::string text = line;
    std::replace(text.begin(), text.end(), ',', ' ');
    std::istringstream words(text);
    std::array<double, 8> v{};
    std::size_t count = 0;
    while (count < v.size() && words >> v[count]) ++count;
    std::string rest;
    words.clear();
    words >> rest;
    if (count == 0 && number == 1) continue;  // names of the columns
    if (count != v.size() || !rest.empty()) {
      return Error{path + ", line " + std::to_string(number) + ": \"" + line +
                   "\"; expected the eight numbers t, x, y, z, qw, qx, qy, qz"};
    }
    track.keys.push_back({v[0], {v[1], v[2], v[3]}, {v[4], v[5], v[6], v[7]}});
  }
  if (auto r = check_poses(track); !r) return Error{path + ": " + r.error()};
  for (Pose& p : track.keys) p.rotation = unit(p.rotation);
  return track;
}

}  // namespace isochor
