#include "scenes/effects/shared_keys.h"

#include <cmath>

namespace isochor::keys {

namespace {

Vec3 rotation_vector(const std::array<double, 4>& q) {
  const Vec3 axis{q[1], q[2], q[3]};
  const double sine = std::sqrt(dot(axis, axis));
  return sine > 0 ? (2 * std::atan2(sine, q[0]) / sine) * axis : Vec3{};
}

std::array<double, 4> quaternion(const Vec3& turn) {
  const double angle = std::sqrt(dot(turn, turn));
  const double s = angle > 0 ? std::sin(0.5 * angle) / angle : 0.5;
  return {std::cos(0.5 * angle), s * turn.x, s * turn.y, s * turn.z};
}

}  // namespace

void describe(Visitor& io, Selection& s) {
  const Selection d;
  io.about("selection", "Nodes that fit any of the criteria.");
  io.body(body_key, s.body);
  io.names(surfaces_key, s.surfaces);
  io.names({"regions", "", "of the mesh"}, s.regions);
  io.names({"node_sets", "", "of the mesh or of the body"}, s.node_sets);
  io.indices({"nodes", "", "of the body's mesh, counted from 0"}, s.nodes);
  io.boxes({"boxes", "m", "`[[lower, upper], ...]`, rest positions"}, s.boxes);
  io.points({"nearest", "m", "the node nearest to each point"}, s.nearest);
  io.flag({"everything", "", "all nodes of the body"}, s.everything, d.everything);
}

void describe(Visitor& io, Prestretch& p) {
  const Prestretch d;
  io.about("prestretch",
           "Stretch of a sheet where the body is at rest, seen from the sheet without stress, see "
           "[shells](effects/shell.md#fibers-and-prestretch).");
  io.number(Key("along", "", "its direction").above(0), p.along, d.along);
  io.number(Key("across", "", "across it").above(0), p.across, d.across);
  io.vector({"direction", "", "projected into each face"}, p.direction, d.direction);
}

// The rotation of a keyframe as a vector: axis times angle [rad].
void describe(Visitor& io, Pose& p) {
  const Pose d;
  io.about("keyframe", "A pose at a time.");
  io.number({"t", "s", "when"}, p.t, d.t);
  io.vector({"position", "m", "of the obstacle's own origin"}, p.position, d.position);
  Vec3 turn = rotation_vector(p.rotation);
  io.vector({"turn", "rad", "axis times angle"}, turn, Vec3{});
  p.rotation = quaternion(turn);
}

void describe(Visitor& io, Obstacle& o) {
  const Obstacle d;
  io.about("obstacle", "A rigid shape that rests or is moved, see [contact](effects/contact.md).");
  io.word({"shape", "", "what it is"}, o.shape, d.shape);
  io.vector({"position", "m", "of its middle"}, o.position, d.position);
  io.vector({"axis", "", "direction of its own z axis: the normal of a plane"}, o.axis, d.axis);
  io.vector({"side", "", "direction of its own x axis"}, o.side, d.side);
  io.number(Key("radius", "m", "of a sphere, capsule or cylinder").least(0), o.radius, d.radius);
  io.number(Key("length", "m", "along its own z axis; of a capsule between the middles of its ends").least(0),
            o.length, d.length);
  io.vector({"size", "m", "edges of a box"}, o.size, d.size);
  io.number(Key("rounding", "m",
                "radius of the edges of boxes and cylinders; what meshes and distance fields grow by")
                .least(0),
            o.rounding, d.rounding);
  io.text({"file", "",
           "of a mesh: `.obj`, `.stl` or a volume mesh; of a distance field: `.vtk` (structured points) or "
           "`.sdf`, or with a `spacing` a surface as for a mesh"},
          o.file, d.file);
  io.number(Key("scale", "", "multiplies the coordinates of the file").above(0), o.scale, d.scale);
  io.number(Key("spacing", "m", "of the points of a distance field that is made from a surface").least(0),
            o.spacing, d.spacing);
  io.text({"motion", "", "a file of poses that moves it, as for bones"}, o.motion.file, d.motion.file);
  io.list({"keyframes", "", "instead of a file"}, o.motion.keys);
}

}  // namespace isochor::keys
