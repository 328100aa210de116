// Points against a rigid shape: where both are, the gap between them and its derivatives.
#pragma once

#include <optional>

#include "constraints/contact/friction/friction_point.h"
#include "constraints/contact/rigid/contact_frame.h"
#include "engine/scene/live_pose.h"
#include "engine/system/pool.h"

namespace isochor {

// A node of a soft body, or a point that rides on a free rigid body.
struct RigidPoint {
  double stick = 0;   // stiffness of friction that sticks [N/m]
  double size = 0;    // of the cells at the node; 0 of what rides [m]
  Vec3 inset{};       // where the distance is taken, less where the point is, in the axes of the shape [m]
  double offset = 0;  // distance that counts as touching [m]
  std::optional<ControlPoints> rider;  // the body that it rides on, and where in its axes
  Vec3 own{};
};

// A shape that has a given pose, or is that of a free rigid body with its control points.
class PlacedShape {
 public:
  // The pose of `shape` counts where there are no control points; `live`: what moves it in place of its own
  // motion.
  PlacedShape(Obstacle shape, std::optional<ControlPoints> points, std::shared_ptr<const LivePose> live)
      : shape_(std::move(shape)), points_(points), live_(std::move(live)) {}

  const Obstacle& shape() const { return shape_; }
  const std::optional<ControlPoints>& shape_points() const { return points_; }
  // At positions x and time t.
  ContactFrame frame(double t, std::span<const Vec3> x) const {
    return points_ ? frame_of(*points_, x) : frame_of(pose_of(shape_, track(), t));
  }
  bool moves() const { return !points_ && !track().keys.empty(); }
  bool moves(double t0, double t1) const;

 private:
  const PoseTrack& track() const { return live_ ? live_->track() : shape_.motion; }

  Obstacle shape_;
  std::optional<ControlPoints> points_;
  std::shared_ptr<const LivePose> live_;
};

// Control points of the shape are nodes of every stencil, behind those of the point. The gap is the distance
// to the shape less an offset, negative inside. With the position in the shape's axes A y = p - c and the
// weights c_i of the nodes in the motion of the point relative to the shape,
//   d gap/dx_i = c_i n,  n = A^-T grad d(y).
class RigidGeometry : public PlacedShape {
 public:
  static constexpr std::size_t kMost = 8;  // nodes of a stencil
  struct Frames {
    ContactFrame before, now, lag;
    std::span<const Vec3> x;  // now
  };
  struct Gap {
    double value = 0;
    Vec3 own{};  // where the distance is taken, in the axes of the shape [m]
    Distance distance;
    Vec3 normal{};  // in space
    std::array<double, kMost> weight{};
    Vec3 slope(std::size_t i, double factor) const { return factor * weight[i] * normal; }
  };
  // In the axes of the shape the point and where it touches, and of a point on a rigid body the same place in
  // the axes of that; the slope of the distance in space.
  struct TouchAt : Touch<kMost> {
    Vec3 own{}, touch{}, place{}, slope{};
  };
  class Rates;  // rigid_touch.cpp

  explicit RigidGeometry(Obstacle shape, std::optional<ControlPoints> points = {},
                         std::shared_ptr<const LivePose> live = nullptr)
      : PlacedShape(std::move(shape), points, std::move(live)) {}
  void add(Index node, double stick, double size = 0, const Vec3& inset = {});
  // A point of a free rigid body at `own` in its axes, which keeps `offset` away.
  void add(const ControlPoints& body, const Vec3& own, double offset, double stick);

  const Lists& nodes() const { return nodes_; }
  const RigidPoint& operator[](Index s) const { return point_[at(s)]; }

  Vec3 position(Index s, std::span<const Vec3> x) const;
  // Where the distance of a point is taken, in the axes of the shape.
  Vec3 own_place(Index s, const ContactFrame& frame, std::span<const Vec3> x) const {
    return frame.to_own(position(s, x)) + point_[at(s)].inset;
  }
  double gap(Index s, const ContactFrame& frame, std::span<const Vec3> x) const {
    return distance_value(shape(), own_place(s, frame, x)) - point_[at(s)].offset;
  }
  // Weights of the nodes in the motion of a point at `own` in the shape's axes, relative to the shape.
  std::array<double, kMost> weights(Index s, const Vec3& own) const;

  // What FrictionalPool asks.
  bool meets(Index) const { return true; }
  double open() const { return 0; }  // never asked: the shape is there for every point
  double stick(Index s) const { return point_[at(s)].stick; }
  Frames frames(const StencilRequest& request) const;
  Gap gap_at(const Frames& frames, Index s, Want want) const;
  void add_curvature(const StencilRequest& request, const Frames& frames, const Gap& gap, Index s,
                     Mat3* blocks) const;
  TouchAt touch(const StencilRequest& request, const Frames& frames, Index s) const;
  Vec3 to_space(const Frames& frames, Index, const Vec3& own) const { return frames.lag.A * own; }
  Vec3 to_own(const Frames& frames, Index, const Vec3& v) const { return frames.now.inverse * v; }
  Rates rates(const StencilRequest& request, const Frames& frames, Index s, const TouchAt& touch) const;

 private:
  Lists nodes_;
  std::vector<RigidPoint> point_;
};

}  // namespace isochor
