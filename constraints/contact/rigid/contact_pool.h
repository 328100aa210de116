// Stencils of points against a rigid shape: the gap, and the potential of friction over an increment.
#pragma once

#include <optional>

#include "constraints/contact/friction/friction_spring.h"
#include "constraints/contact/rigid/contact_frame.h"
#include "engine/system/pool.h"

namespace isochor {

// One point a stencil and one function, its distance to the shape less an offset [m], negative inside. Its
// multiplier is minus the normal force. The point is a node of a soft body, or rides on a free rigid body;
// the shape has a given pose, or is that of a free rigid body, whose control points then are nodes of every
// stencil, behind those of the point. With the position in the shape's axes A y = p - c and the weights
// c_i of the nodes in the motion of the point relative to the shape,
//   d gap/dx_i = c_i n,  n = A^-T grad d(y).
//
// Friction is the energy of friction_spring.h, its normal force, tangent plane and weights c_i those of the
// last iteration: of the slip u since the increment began and the pull f0 that the last step left, z = u + f0
// / k. The pull is kept between steps, so that what sticks does not creep.
class ContactPool final : public StencilPool {
 public:
  // The pose of `shape` counts where there are no control points.
  ContactPool(std::string name, Obstacle shape, FrictionLaw friction,
              std::optional<ControlPoints> points = {}, bool coupled = false)
      : name_(std::move(name)),
        shape_(std::move(shape)),
        friction_(friction),
        coupled_(coupled),
        points_(points) {}
  // `stick`: stiffness of friction that sticks [N/m]; `size`: of the cells at the node [m]; `inset`: where
  // the distance is taken, less where the node is, in the axes of the shape [m].
  void add(Index node, double stick, double size = 0, const Vec3& inset = {});
  // A point of a free rigid body at `own` in its axes, which keeps `offset` away.
  void add(const ControlPoints& body, const Vec3& own, double offset, double stick);
  void finish() { finish_topology(); }

  std::string_view name() const override { return name_; }
  bool has_energy() const override { return friction_.any(); }
  int functions() const override { return 1; }
  bool sees_rigid_motion() const override { return !points_; }
  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override;

  bool has_lag() const override { return friction_.any(); }
  bool couples() const override { return coupled_ && has_lag(); }
  // contact_coupling.cpp
  void lag_derivatives(const StencilRequest& request, const LagSlots& slots) const override;
  // By point: the pull in the axes of the shape, then what the law keeps.
  int memory() const override { return friction_.any() ? memory_per_point() * stencils() : 0; }
  void accept(const StencilRequest& request, std::span<double> memory) const override;
  bool has_barrier() const override { return shape_.shape != ObstacleShape::plane; }
  Index passing(const StencilIncrement& increment, std::span<const Vec3> x,
                std::span<Vec3> stopped) const override;
  double entry(double t0, double t1, std::span<const Vec3> from, std::span<const Vec3> x) const override;

  // Whether the shape is where a pose says, and no free rigid body.
  bool follows_pose() const { return !points_; }
  // Whether the point of a stencil is on a rigid body and not a node.
  bool rides(Index s) const { return rider_[at(s)].has_value(); }
  // The pull of friction that a step left, in the axes of the shape [N].
  Vec3 kept_pull(Index s, std::span<const double> memory) const;
  // Position of the point of a stencil, and the frame of the shape, at positions x and time t.
  Vec3 point(Index s, std::span<const Vec3> x) const;
  ContactFrame frame(double t, std::span<const Vec3> x) const {
    return points_ ? frame_of(*points_, x) : frame_of(pose_of(shape_, t));
  }
  // Where the distance of a stencil is taken, in the axes of the shape.
  Vec3 own_place(Index s, const ContactFrame& frame, std::span<const Vec3> x) const {
    return frame.to_own(point(s, x)) + inset_[at(s)];
  }
  double gap(Index s, const ContactFrame& frame, std::span<const Vec3> x) const;
  // Impacts, in contact_impact.cpp. Rate of the gap [m/s] when an increment begins, at velocities v + jump;
  // obstacles move as they will until it ends. And what a unit impulse along the normal does: velocities of
  // the nodes of the stencil, and the rate of the gap.
  double gap_rate(Index s, const RowStart& start, const ContactFrame& frame, const ContactFrame& later,
                  std::span<const Vec3> jump) const;
  struct Impact {
    std::array<Vec3, 8> velocity{};  // [m/s over N s]
    double mobility = 0;             // [1/kg]
  };
  Impact impact(Index s, const RowStart& start, const ContactFrame& frame) const;
  const Obstacle& shape() const { return shape_; }

 private:
  static constexpr std::size_t kMost = 8;  // nodes of a stencil
  struct Frames {
    ContactFrame before, now, lag;
  };
  struct Friction {
    FrictionSpring spring;
    double mu = 0;  // coefficient of this step
    std::array<double, kMost> weight{};
    // Of the lag: the point in the axes of the shape, where it touches there and, of a point on a rigid body,
    // in those of its own; the pull kept, in the axes of the shape; the slope of the distance in space; slip
    // and stretch before they are projected on the tangent plane.
    Vec3 own{}, touch{}, place{}, kept{}, slope{}, whole{};
  };
  struct FrictionRate {
    Vec3 pull{};
    std::array<double, kMost> weight{};
  };
  Frames frames(const StencilRequest& request) const;
  std::array<double, kMost> weights(Index s, const Vec3& own) const;
  Friction friction(const StencilRequest& request, const Frames& frames, Index s) const;
  int memory_per_point() const { return 3 + friction_.memory(); }
  double coefficient(Index s, std::span<const double> memory) const;
  FrictionRate friction_rate(const StencilRequest& request, const Frames& frames, Index s, const Friction& f,
                             const Mat3& curvature, std::size_t node, const Vec3& rate) const;
  void add_curvature(const StencilRequest& request, const Distance& d, const ContactFrame& frame,
                     const Vec3& own, Index s, Mat3* blocks) const;

  std::string name_;
  Obstacle shape_;
  FrictionLaw friction_;
  bool coupled_;
  std::optional<ControlPoints> points_;
  bool meets_elsewhere(Index s, const Vec3& y0, const Vec3& y1, Vec3& met) const;
  std::vector<double> stick_, offset_;
  // Of nodes: the size of their cells, 0 of points on rigid bodies [m]; and as in add().
  std::vector<double> size_;
  std::vector<Vec3> inset_;
  // Of points on a free rigid body: which, and where; a node has none.
  std::vector<std::optional<ControlPoints>> rider_;
  std::vector<Vec3> rider_own_;
};

}  // namespace isochor
