#include "live/poses.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "live/turns.h"
#include "scenes/body_parts.h"
#include "scenes/effects/kind.h"

namespace isochor::live {

namespace {

constexpr double kTravel = 0.03;  // the most that a step moves something, over the extent of the bodies
constexpr double kTurn = 0.06;    // likewise the most that it turns it [rad]

double length(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

Pose at_rest(const PoseTrack& said) {
  return said.keys.empty() ? Pose{} : said.keys.front();
}

bool within(const Vec3& p, const std::array<Vec3, 2>& box) {
  for (int k = 0; k < 3; ++k) {
    if (p[k] < box[0][k] || p[k] > box[1][k]) return false;
  }
  return true;
}

// "z", or "(0.6, 0, 0.8)".
std::string name_of(const Vec3& direction) {
  std::string out;
  for (int k = 0; k < 3; ++k) {
    if (direction[k] == 1) return std::string(1, "xyz"[k]);
    char text[16];
    std::snprintf(text, sizeof text, "%.3g", std::abs(direction[k]) < 5e-4 ? 0.0 : direction[k]);
    out += (k == 0 ? "(" : ", ") + std::string(text);
  }
  return out + ")";
}

// Of unit length, without its parts along the others, its largest part positive; zero where nothing is left.
Vec3 apart(Vec3 direction, const std::vector<Vec3>& others) {
  const double size = length(direction);
  if (!(size > 0)) return {};
  direction = (1 / size) * direction;
  for (const Vec3& other : others) direction -= dot(direction, other) * other;
  const double left = length(direction);
  if (left < 1e-6) return {};
  int largest = 0;
  for (int k = 1; k < 3; ++k) {
    if (std::abs(direction[k]) > 1.000001 * std::abs(direction[largest])) largest = k;
  }
  return ((direction[largest] < 0 ? -1 : 1) / left) * direction;
}

const std::vector<Vec3> kAxes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

// Orthonormal directions that span those asked for; axes of coordinates among them where they are held.
std::vector<Vec3> span_of(const std::vector<Vec3>& asked) {
  std::vector<Vec3> span, out;
  for (const Vec3& direction : asked) {
    const Vec3 next = apart(direction, span);
    if (length(next) > 0) span.push_back(next);
  }
  for (const Vec3& axis : kAxes) {
    if (length(apart(axis, span)) == 0) out.push_back(axis);
  }
  for (const Vec3& direction : span) {
    const Vec3 next = apart(direction, out);
    if (length(next) > 0) out.push_back(next);
  }
  return out;
}

// A plane that is held turns about its normal. Along one direction alone a turn would tilt what is held, but
// not the direction: what slides there would not stay on the tilted plane.
std::vector<PoseAxis> axes_of(const std::vector<Vec3>& held) {
  std::vector<PoseAxis> out;
  for (const Vec3& d : held) out.push_back({"along " + name_of(d), d, false});
  std::vector<Vec3> about;
  if (held.size() == 3) about = held;
  if (held.size() == 2) about = span_of({cross(held[0], held[1])});
  for (const Vec3& d : about) out.push_back({"turned about " + name_of(d), d, true});
  return out;
}

// The middle of what a support names; of the whole body where it names regions or what is nearest.
Vec3 middle_of(const Mesh& mesh, const DirichletDef& def) {
  const Selection& where = def.where;
  Vec3 sum{};
  double count = 0;
  const auto add = [&](const std::vector<Index>& nodes) {
    for (const Index n : nodes) sum += mesh.nodes[static_cast<std::size_t>(n)];
    count += static_cast<double>(nodes.size());
  };
  const auto names = [](const std::vector<std::string>& list, const std::string& name) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  for (const MeshSurface& s : mesh.surfaces) {
    if (names(where.surfaces, s.name)) add(s.faces);
  }
  for (const auto& s : mesh.node_sets) {
    if (names(where.node_sets, s.name)) add(s.nodes);
  }
  add(where.nodes);
  for (const auto& box : where.boxes) {
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      if (within(mesh.nodes[n], box)) add({static_cast<Index>(n)});
    }
  }
  for (const Vec3& p : def.points) sum += p;
  count += static_cast<double>(def.points.size());
  if (count == 0) {
    for (const Vec3& p : mesh.nodes) sum += p;
    count = static_cast<double>(mesh.nodes.size());
  }
  return count > 0 ? (1 / count) * sum : sum;
}

}  // namespace

Poses::Poses(const SceneDef& scene, const BuiltScene& built, double extent) : extent_(extent) {
  // Steps along a path have no time in which something could move.
  if (scene.analysis.path_step) return;
  add_obstacles(scene, built);
  add_supports(scene, built);
}

void Poses::add_obstacles(const SceneDef& scene, const BuiltScene& built) {
  for (std::size_t i = 0; i < scene.contacts.size() && i < built.obstacles.size(); ++i) {
    const ContactDef& def = scene.contacts[i];
    if (!def.against.empty()) continue;  // a free body, which is where forces put it
    const Obstacle& o = built.obstacles[i];
    things_.push_back(
        {"obstacle of " + def.name, &contacts_kind, i, o.position, o.motion, o.motion, axes_of(kAxes), {}});
  }
}

void Poses::add_supports(const SceneDef& scene, const BuiltScene& built) {
  for (std::size_t i = 0; i < scene.dirichlet.size(); ++i) {
    const DirichletDef& def = scene.dirichlet[i];
    // What is displaced by an amount has a slider for that.
    if (length(def.displacement) > 0 || def.angle != 0) continue;
    PoseTrack said = def.bone;
    if (said.keys.empty() && !said.file.empty()) {
      auto read = read_poses(path_in(scene.folder, said.file));
      if (!read) continue;
      said = std::move(read).value();
    }
    const auto body = static_cast<std::size_t>(def.where.body);
    const Mesh& mesh = built.world.mesh(built.bodies[body]);
    things_.push_back({"support " + def.name,
                       &dirichlet_kind,
                       i,
                       middle_of(mesh, def),
                       said,
                       said,
                       axes_of(def.directions.empty() ? kAxes : span_of(def.directions)),
                       {}});
  }
}

double Poses::reach(std::size_t thing) const {
  double out = 0;
  for (const Pose& key : things_[thing].said.keys)
    out = std::max(
        out, length(carried(things_[thing].said, key.t, things_[thing].middle) - things_[thing].middle));
  return out;
}

Placement Poses::placement(const Thing& thing, double time) {
  const Pose now = pose_at(thing.now, time), rest = at_rest(thing.said);
  const Quaternion turn = product(now.rotation, inverse(rest.rotation));
  return {turned(turn, thing.middle - rest.position) + now.position - thing.middle, turn_of(turn)};
}

Placement Poses::wanted(std::size_t thing, double time) const {
  const Thing& t = things_[thing];
  return t.wanted ? *t.wanted : placement(t, time);
}

double Poses::stride(const Placement& from, const Placement& to) const {
  const double way = length(to.shift - from.shift);
  const double turn = length(turn_of(product(quaternion(to.turn), inverse(quaternion(from.turn)))));
  const double left = std::max(way / (kTravel * extent_), turn / kTurn);
  return left < 1e-9 ? 0 : std::min(1.0, 1 / left);
}

Result<void> Poses::prepare(BuiltScene& built, double h) {
  const double time = built.world.time();
  for (Thing& thing : things_) {
    if (!thing.wanted) continue;
    const Placement from = placement(thing, time), to = *thing.wanted;
    const double s = stride(from, to);
    if (s == 0) continue;
    const PoseTrack way{{{0, from.shift, quaternion(from.turn)}, {1, to.shift, quaternion(to.turn)}}, {}};
    const Pose next = s < 1 ? pose_at(way, s) : way.keys.back();
    const Pose rest = at_rest(thing.said);
    Pose pose;
    pose.rotation = product(next.rotation, rest.rotation);
    pose.position = thing.middle + next.position + turned(next.rotation, rest.position - thing.middle);
    if (auto r = built.world.set_pose(built.ids(*thing.kind)[thing.place], pose); !r) return r;
    // As the world has it: on its way over the step.
    Pose before = pose_at(thing.now, time), first = rest;
    before.t = time;
    first.t = time - 1;
    pose.t = time + h;
    thing.now.keys = {first, before, pose};
    if (thing.kind == &contacts_kind) built.obstacles[thing.place].motion = thing.now;
  }
  return {};
}

bool Poses::arrived(double time) const {
  return std::all_of(things_.begin(), things_.end(), [&](const Thing& thing) {
    return !thing.wanted || stride(placement(thing, time), *thing.wanted) == 0;
  });
}

void Poses::forget(BuiltScene& built) {
  for (Thing& thing : things_) {
    thing.wanted.reset();
    thing.now = thing.said;
    if (thing.kind == &contacts_kind) built.obstacles[thing.place].motion = thing.said;
  }
}

}  // namespace isochor::live
