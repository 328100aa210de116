#include "live/hand.h"

#include <algorithm>
#include <cmath>

#include "live/turns.h"

namespace isochor::live {

namespace {

constexpr double kPatch = 0.03;   // radius of what fingers hold, over the extent of the scene
constexpr double kSphere = 0.08;  // radius of a sphere that pushes, likewise
constexpr double kTravel = 0.03;  // the most that a handle moves in a step, likewise
constexpr double kPin = 150;      // stiffness of a pin over that of a pull

double length(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

// Nodes within the radius, and the three nearest in any case: fewer have no rotation.
std::vector<Index> nodes_around(const Mesh& mesh, const Vec3& point, double radius) {
  std::vector<std::pair<double, Index>> all;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    all.emplace_back(length(mesh.nodes[n] - point), static_cast<Index>(n));
  const std::size_t least = std::min<std::size_t>(4, all.size());
  std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(least), all.end());
  std::vector<Index> out;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (k < least || all[k].first <= radius) out.push_back(all[k].second);
  }
  return out;
}

// The rigid motion of a patch now: a point X of it is at turn X + shift.
Pose motion_of(const Selection& patch, BodyId body, const BuiltScene& built) {
  Pose pose;
  pose.t = built.world.time();
  if (const auto turn = built.world.orientation(patch); turn && length(turn.value().axis) > 0.5)
    pose.rotation = quaternion(turn.value().axis, turn.value().angle);
  const auto x = built.world.positions(body), rest = built.world.rest_positions(body);
  Vec3 middle{}, middle_rest{};
  for (const Index n : patch.nodes) {
    middle += x[static_cast<std::size_t>(n)];
    middle_rest += rest[static_cast<std::size_t>(n)];
  }
  const double each = 1.0 / static_cast<double>(patch.nodes.size());
  pose.position = each * middle - turned(pose.rotation, each * middle_rest);
  return pose;
}

Vec3 carried_by(const Pose& pose, const Vec3& rest) {
  return turned(pose.rotation, rest) + pose.position;
}

}  // namespace

std::optional<std::size_t> Hand::find(int id) const {
  for (std::size_t i = 0; i < held_.size(); ++i) {
    if (held_[i].state.id == id) return i;
  }
  return {};
}

Result<int> Hand::hold(HandleKind kind, const Hit& hit, double stiffness, BuiltScene& built) {
  if (held_.size() >= most)
    return Error{std::to_string(most) + " points are held already; release one of them first"};
  return kind == HandleKind::push ? push(hit, built) : pull(kind, hit, stiffness, built);
}

Result<int> Hand::pull(HandleKind kind, const Hit& hit, double stiffness, BuiltScene& built) {
  Held held;
  held.body = built.bodies[hit.body];
  held.rest = hit.rest;
  held.state.id = next_;
  held.state.kind = kind;
  held.state.radius = kPatch * extent_;
  held.patch.body = held.body;
  held.patch.nodes = nodes_around(built.world.mesh(held.body), hit.rest, held.state.radius);
  DirichletDef def;
  def.name = "hand " + std::to_string(next_);
  def.where = held.patch;
  def.treatment = SupportTreatment::stiffness;
  def.stiffness = kind == HandleKind::pin ? kPin * stiffness : stiffness;
  // It begins where the patch is now, so that holding alone moves nothing.
  const Pose now = motion_of(held.patch, held.body, built);
  Pose before;
  before.t = now.t - 1;
  def.bone.keys = {before, now};
  auto added = built.world.add(dirichlet(def));
  if (!added) return added.failure();
  if (auto r = built.world.compile(); !r) return r.failure();
  held.effect = added.value();
  held.state.at = held.state.to = held.reached = carried_by(now, hit.rest);
  held_.push_back(std::move(held));
  return next_++;
}

Result<int> Hand::push(const Hit& hit, BuiltScene& built) {
  Held held;
  held.body = built.bodies[hit.body];
  held.state.id = next_;
  held.state.kind = HandleKind::push;
  // Nodes are what it touches: between those of a coarse surface a small one would slip through.
  held.state.radius = std::max(kSphere * extent_, 1.5 * hit.size);
  // A little way off, so that it begins without touching.
  held.rest = hit.now + 1.05 * held.state.radius * hit.normal;
  ContactDef def;
  def.name = "hand " + std::to_string(next_);
  def.body = held.body;
  def.obstacle.shape = ObstacleShape::sphere;
  def.obstacle.position = held.rest;
  def.obstacle.radius = held.state.radius;
  def.initial_overlap = InitialOverlap::resolve;
  def.resolve_time = 1e-3;
  auto added = built.world.add(contact(def));
  if (!added) return added.failure();
  if (auto r = built.world.compile(); !r) return r.failure();
  held.effect = added.value();
  held.state.at = held.state.to = held.reached = held.rest;
  held_.push_back(std::move(held));
  return next_++;
}

Result<void> Hand::move(int id, const Vec3& to) {
  const auto i = find(id);
  if (!i) return Error{"handle " + std::to_string(id) + " is not there (any more)"};
  // Beyond that nothing is to be seen, and no step would get there.
  if (length(to - held_[*i].rest) > 20 * extent_)
    return Error{"handle " + std::to_string(id) + " is wanted too far from the scene"};
  held_[*i].state.to = to;
  return {};
}

Result<void> Hand::release(int id, BuiltScene& built) {
  const auto i = find(id);
  if (!i) return Error{"handle " + std::to_string(id) + " is not there (any more)"};
  if (auto r = built.world.remove(held_[*i].effect); !r) return r;
  if (auto r = built.world.compile(); !r) return r;
  held_.erase(held_.begin() + static_cast<std::ptrdiff_t>(*i));
  return {};
}

Result<void> Hand::prepare(BuiltScene& built) {
  for (Held& h : held_) {
    Vec3 way = h.state.to - h.reached;
    const double most_way = kTravel * extent_, far = length(way);
    if (far > most_way) way = (most_way / far) * way;
    h.reached += way;
    Pose pose;
    if (h.state.kind == HandleKind::push) {
      pose.position = h.reached - h.rest;
    } else if (h.state.kind == HandleKind::pin && far == 0) {
      continue;
    } else {
      // The spring follows the turn of what it holds: it pulls and does not twist.
      pose = motion_of(h.patch, h.body, built);
      pose.position = h.reached - turned(pose.rotation, h.rest);
    }
    if (auto r = built.world.set_pose(h.effect, pose); !r) return r;
  }
  return {};
}

bool Hand::arrived() const {
  return std::all_of(held_.begin(), held_.end(),
                     [](const Held& h) { return length(h.state.to - h.reached) == 0; });
}

void Hand::forget() {
  held_.clear();
}

std::vector<HandleState> Hand::states(const BuiltScene& built) const {
  std::vector<HandleState> out;
  for (const Held& h : held_) {
    HandleState s = h.state;
    if (h.state.kind == HandleKind::push) {
      s.at = h.reached;
      for (const Gauge& g : built.world.gauges()) {
        if (g.effect == built.world.effect_name(h.effect) && g.unit == "N")
          s.force = std::max(s.force, std::abs(g.value));
      }
    } else {
      s.at = carried_by(motion_of(h.patch, h.body, built), h.rest);
      s.force = length(built.world.reaction(h.effect)[0]);
    }
    out.push_back(s);
  }
  return out;
}

}  // namespace isochor::live
