// A free rigid body: four points of equal mass that keep their six distances.
#include "constraints/contact/rigid/rigid_body.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "constraints/contact/shape/closed_surface.h"
#include "constraints/contact/shape/moved_solid.h"
#include "constraints/stencil/segment_pool.h"
#include "engine/base/text.h"
#include "isochor/effects/contact.h"

namespace isochor {

namespace {

constexpr double kPi = std::numbers::pi;

struct Mass {
  double volume = 0;
  Vec3 square{};  // mean of y_k^2 [m^2]
};

Mass mass_of(const Obstacle& s) {
  const double r = s.radius, l = s.length;
  switch (s.shape) {
    case ObstacleShape::plane:
      break;
    case ObstacleShape::sphere:
      return {4.0 / 3 * kPi * r * r * r, {r * r / 5, r * r / 5, r * r / 5}};
    case ObstacleShape::capsule: {
      const double tube = kPi * r * r * l, ends = 4.0 / 3 * kPi * r * r * r, sum = tube + ends;
      const double across = (tube * r * r / 4 + ends * r * r / 5) / sum;
      const double along = (tube * l * l / 12 + ends * (r * r / 5 + 0.375 * l * r + l * l / 4)) / sum;
      return {sum, {across, across, along}};
    }
    case ObstacleShape::cylinder:
      return {kPi * r * r * l, {r * r / 4, r * r / 4, l * l / 12}};
    case ObstacleShape::box:
      return {s.size.x * s.size.y * s.size.z,
              {s.size.x * s.size.x / 12, s.size.y * s.size.y / 12, s.size.z * s.size.z / 12}};
    case ObstacleShape::mesh:
    case ObstacleShape::distance_field: {
      const SolidMoments m = moments_of(s.solid->outline());
      return {m.volume, {m.second[0], m.second[1], m.second[2]}};
    }
  }
  return {};
}

class DistanceRows final : public RowPool {
 public:
  explicit DistanceRows(std::string name) : name_(std::move(name)) {}
  std::string_view name() const override { return name_; }

 private:
  std::string name_;
};

// Unit vector about which A0 has been turned into A; any where it has not. Half a turn leaves its sign open.
Vec3 turn_axis(const Mat3& A, const Mat3& A0) {
  Mat3 R;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) R(i, j) = A(i, 0) * A0(j, 0) + A(i, 1) * A0(j, 1) + A(i, 2) * A0(j, 2);
  }
  Vec3 axis{R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1)};
  const double trace = R(0, 0) + R(1, 1) + R(2, 2);
  // Near half a turn the antisymmetric part vanishes, and R + 1 is twice the axis times itself.
  if (trace < -0.999) {
    int k = 0;
    for (int i = 1; i < 3; ++i) k = R(i, i) > R(k, k) ? i : k;
    const Vec3 column{R(0, k) + (k == 0), R(1, k) + (k == 1), R(2, k) + (k == 2)};
    axis = dot(column, axis) < 0 ? -1.0 * column : column;
  }
  const double length = std::sqrt(dot(axis, axis));
  return length > 0 ? (1 / length) * axis : Vec3{};
}

class RigidBodyInstance final : public EffectInstance {
 public:
  RigidBodyInstance(std::string name, const ControlPoints& points)
      : name_(std::move(name)), points_(points) {}
  void gauges(const GaugeContext& c, std::vector<Gauge>& out) const override {
    Vec3 x{}, v{};
    for (const Index n : points_.node) {
      x += 0.25 * c.state.x[at(n)];
      v += 0.25 * c.state.v[at(n)];
    }
    out.push_back({name_, "rigid_body", "x", "m", x.x});
    out.push_back({name_, "rigid_body", "y", "m", x.y});
    out.push_back({name_, "rigid_body", "z", "m", x.z});
    out.push_back({name_, "rigid_body", "speed", "m/s", std::sqrt(dot(v, v))});
    // How far it has turned from where it was at rest.
    const Mat3 A = frame_of(points_, c.state.x).A, A0 = frame_of(points_, c.system.parts().rest).A;
    double trace = 0;
    for (std::size_t k = 0; k < 9; ++k) trace += A.m[k] * A0.m[k];
    const double angle = std::acos(std::min(1.0, std::max(-1.0, 0.5 * (trace - 1))));
    out.push_back({name_, "rigid_body", "turn", "rad", angle});
    const Vec3 turn = angle * turn_axis(A, A0);
    out.push_back({name_, "rigid_body", "turn_x", "rad", turn.x});
    out.push_back({name_, "rigid_body", "turn_y", "rad", turn.y});
    out.push_back({name_, "rigid_body", "turn_z", "rad", turn.z});
  }

 private:
  std::string name_;
  ControlPoints points_;
};

class RigidBodyEffect final : public EffectSource {
 public:
  explicit RigidBodyEffect(RigidBodyDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    if (auto r = check_obstacle(def_.shape); !r) return Error{who() + r.error()};
    if (def_.shape.shape == ObstacleShape::plane) {
      return Error{who() + "a plane has no end and no mass; take any other shape"};
    }
    if (!def_.shape.motion.keys.empty()) {
      return Error{who() + "a free body moves by forces; leave its motion out, or make it an obstacle"};
    }
    if (is_solid(def_.shape) && def_.shape.rounding > 0) {
      return Error{who() + "rounding = " + number(def_.shape.rounding) +
                   " m would add a mass that its surface does not show; leave it at 0"};
    }
    if (!(def_.density > 0) || !std::isfinite(def_.density)) {
      return Error{who() + "density = " + number(def_.density) + " kg/m^3; it must be positive"};
    }
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    if (builder.quasi_static()) {
      return Error{who() +
                   "a free rigid body has no equilibrium to find by itself; use a dynamic scheme, or "
                   "an obstacle whose motion is given"};
    }
    auto shared = builder.shared<RigidBodies>(kRigidBodies);
    if (shared->by_name.count(def_.name) > 0) {
      return Error{who() + "another rigid body has this name; names must differ"};
    }
    const Obstacle shape = principal_form(def_.shape);
    const Mass mass = mass_of(shape);
    RigidShape body{shape, {}};
    for (int k = 0; k < 3; ++k) body.points.radius[k] = std::sqrt(mass.square[k]);
    const ObstaclePose pose = pose_of(shape, 0);
    for (std::size_t a = 0; a < 4; ++a) {
      body.points.node[a] =
          builder.add_point(pose.to_world(body.points.own(a)), 0.25 * def_.density * mass.volume);
    }
    double mu = 0;
    for (Index b = 0; b < builder.body_count(); ++b)
      mu = std::max(mu, stiffest(builder.body(static_cast<BodyId>(b))));
    auto pool = std::make_shared<SegmentPool>(def_.name, false);
    auto rows = std::make_shared<DistanceRows>(def_.name);
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const PointInBody first{{body.points.node[b]}, {1.0}}, second{{body.points.node[a]}, {1.0}};
        if (auto r = pool->add(first, second, builder.rest()); !r) return Error{who() + r.error()};
        const Index row = rows->rows();
        const double length = pool->rest_length(row);
        rows->map.push(std::span(&row, 1));
        rows->weight.push_back(1);
        rows->metric.push_back(1 / (mu * length));
        rows->measure.push_back(length);
      }
    }
    pool->finish();
    rows->stencil_pool = builder.add_stencils(pool);
    builder.add_rows(rows);
    shared->by_name.emplace(def_.name, body);
    return std::unique_ptr<EffectInstance>(std::make_unique<RigidBodyInstance>(def_.name, body.points));
  }

 private:
  std::string who() const { return "rigid body \"" + def_.name + "\": "; }
  RigidBodyDef def_;
};

}  // namespace

Obstacle principal_form(const Obstacle& shape) {
  if (!is_solid(shape)) return shape;
  const SolidMoments m = moments_of(shape.solid->outline());
  Eigen::Matrix3d second;
  second << m.second[0], m.second[3], m.second[4], m.second[3], m.second[1], m.second[5], m.second[4],
      m.second[5], m.second[2];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(second);
  const auto axis = [&](int k) {
    return Vec3{solver.eigenvectors()(0, k), solver.eigenvectors()(1, k), solver.eigenvectors()(2, k)};
  };
  const Vec3 x = axis(0), y = axis(1), z = cross(x, y);
  const Mat3 R{{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}};
  const ObstaclePose pose = pose_of(shape, 0);
  Obstacle out = shape;
  out.solid = std::make_shared<MovedSolid>(shape.solid, m.middle, R);
  out.position = pose.to_world(m.middle);
  out.axis = pose.R * z;
  out.side = pose.R * x;
  return out;
}

Result<RigidShape> find_rigid(Builder& builder, const std::string& name, const std::string& who) {
  const auto shared = builder.shared<RigidBodies>(kRigidBodies);
  const auto found = shared->by_name.find(name);
  if (found != shared->by_name.end()) return found->second;
  std::string known;
  for (const auto& [other, body] : shared->by_name) known += (known.empty() ? "\"" : ", \"") + other + "\"";
  return Error{who + ": there is no rigid body \"" + name + "\" yet; " +
               (known.empty() ? "none was added before" : "those added before are " + known)};
}

std::vector<TouchPoint> touch_points(const Obstacle& s) {
  std::vector<TouchPoint> out;
  const double half = 0.5 * s.length;
  if (s.shape == ObstacleShape::sphere) out.push_back({{}, s.radius});
  if (s.shape == ObstacleShape::capsule) out = {{{0, 0, -half}, s.radius}, {{0, 0, half}, s.radius}};
  if (s.shape == ObstacleShape::box) {
    for (int k = 0; k < 8; ++k) {
      Vec3 y{};
      for (int i = 0; i < 3; ++i) y[i] = ((k >> i) & 1 ? 1 : -1) * (0.5 * s.size[i] - s.rounding);
      out.push_back({y, s.rounding});
    }
  }
  if (is_solid(s)) {
    for (const Vec3& p : s.solid->outline().points) out.push_back({p, 0});
  }
  if (s.shape == ObstacleShape::cylinder) {
    constexpr int around = 12;
    const double r = s.radius - s.rounding;
    for (int k = 0; k < around; ++k) {
      const double phi = 2 * kPi * k / around;
      for (const double side : {-1.0, 1.0}) {
        out.push_back({{r * std::cos(phi), r * std::sin(phi), side * (half - s.rounding)}, s.rounding});
      }
    }
  }
  return out;
}

EffectPtr rigid_body(RigidBodyDef def) {
  return std::make_shared<RigidBodyEffect>(std::move(def));
}

}  // namespace isochor
