#include "constraints/contact/rigid/contact_impact.h"

namespace isochor {

namespace {

// Velocities of the control points of a rigid body of mass m behind an impulse at p.
void rigid_velocities(const ControlPoints& points, const ContactFrame& frame, double m,
                      std::span<const Vec3> x, const Vec3& p, const Vec3& impulse, Vec3* out) {
  const Vec3 torque = transposed_times(frame.A, cross(p - frame.c, impulse));
  const double a = points.radius.x * points.radius.x, b = points.radius.y * points.radius.y,
               c = points.radius.z * points.radius.z;
  const Vec3 spin =
      frame.A * Vec3{torque.x / (m * (b + c)), torque.y / (m * (c + a)), torque.z / (m * (a + b))};
  for (std::size_t k = 0; k < 4; ++k)
    out[k] = (1 / m) * impulse + cross(spin, x[at(points.node[k])] - frame.c);
}

// Velocity at p of the rigid motion that is closest to the velocities of the control points: a time step
// along a chord leaves them one that stretches the body a little.
Vec3 rigid_velocity(const ControlPoints& points, const ContactFrame& frame, const ImpactStart& start,
                    std::span<const Vec3> jump, const Vec3& p) {
  Vec3 mean{}, moment{};  // of momentum over mass
  for (const Index n : points.node) {
    const Vec3 v = jump.empty() ? start.v[at(n)] : start.v[at(n)] + jump[at(n)];
    mean += 0.25 * v;
    moment += 0.25 * cross(start.x[at(n)] - frame.c, v);
  }
  const Vec3 own = transposed_times(frame.A, moment);
  const double a = points.radius.x * points.radius.x, b = points.radius.y * points.radius.y,
               c = points.radius.z * points.radius.z;
  return mean + cross(frame.A * Vec3{own.x / (b + c), own.y / (c + a), own.z / (a + b)}, p - frame.c);
}

double mass_of(const ControlPoints& points, std::span<const double> mass) {
  double m = 0;
  for (const Index n : points.node) m += mass[at(n)];
  return m;
}

}  // namespace

double gap_rate(const RigidGeometry& geometry, Index s, const ImpactStart& start, const ContactFrame& frame,
                const ContactFrame& later, std::span<const Vec3> jump) {
  const Vec3 p = geometry.position(s, start.x), own = geometry.own_place(s, frame, start.x);
  const auto& rider = geometry[s].rider;
  Vec3 rate{};
  if (rider) {
    rate = rigid_velocity(*rider, frame_of(*rider, start.x), start, jump, p);
  } else {
    const std::size_t node = at(geometry.nodes()[s][0]);
    rate = jump.empty() ? start.v[node] : start.v[node] + jump[node];
  }
  if (const auto& points = geometry.shape_points())
    rate -= rigid_velocity(*points, frame, start, jump, p);
  else
    rate -= (1 / (start.t1 - start.t0)) * (later.to_world(own) - frame.to_world(own));
  return dot(transposed_times(frame.inverse, distance_to(geometry.shape(), own).normal), rate);
}

Impact impact(const RigidGeometry& geometry, Index s, const ImpactStart& start, const ContactFrame& frame) {
  const Vec3 p = geometry.position(s, start.x), own = geometry.own_place(s, frame, start.x);
  const Vec3 normal = transposed_times(frame.inverse, distance_to(geometry.shape(), own).normal);
  const auto& rider = geometry[s].rider;
  const auto nodes = geometry.nodes()[s];
  Impact out;
  if (rider) {
    rigid_velocities(*rider, frame_of(*rider, start.x), mass_of(*rider, start.mass), start.x, p, normal,
                     out.velocity.data());
  } else {
    const double m = start.mass[at(nodes[0])];
    out.velocity[0] = (m > 0 ? 1 / m : 0) * normal;
  }
  if (const auto& points = geometry.shape_points()) {
    rigid_velocities(*points, frame, mass_of(*points, start.mass), start.x, p, -normal,
                     out.velocity.data() + (rider ? 4 : 1));
  }
  const auto c = geometry.weights(s, own);
  for (std::size_t i = 0; i < nodes.size(); ++i) out.mobility += c[i] * dot(normal, out.velocity[i]);
  return out;
}

}  // namespace isochor
