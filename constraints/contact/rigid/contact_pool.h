// Stencils of points against a rigid shape.
#pragma once

#include <optional>

#include "constraints/contact/friction/frictional_pool.h"
#include "constraints/contact/rigid/contact_frame.h"

namespace isochor {

// A point is a node of a soft body, or rides on a free rigid body; the shape has a given pose, or is that of
// a free rigid body, whose control points then are nodes of every stencil, behind those of the point. The gap
// is the distance to the shape less an offset, negative inside. With the position in the shape's axes A y = p
// - c and the weights c_i of the nodes in the motion of the point relative to the shape,
//   d gap/dx_i = c_i n,  n = A^-T grad d(y).
class ContactPool final : public FrictionalPool<ContactPool>, public BarrierStencils {
 public:
  // The pose of `shape` counts where there are no control points.
  ContactPool(std::string name, Obstacle shape, FrictionLaw friction,
              std::optional<ControlPoints> points = {}, bool coupled = false);
  // `stick`: stiffness of friction that sticks [N/m]; `size`: of the cells at the node [m]; `inset`: where
  // the distance is taken, less where the node is, in the axes of the shape [m].
  void add(Index node, double stick, double size = 0, const Vec3& inset = {});
  // A point of a free rigid body at `own` in its axes, which keeps `offset` away.
  void add(const ControlPoints& body, const Vec3& own, double offset, double stick);
  void finish() { finish_topology(); }

  bool sees_rigid_motion() const override { return !points_; }
  StencilFacets facets() const override {
    StencilFacets f = friction_facets();
    if (shape_.shape != ObstacleShape::plane) f.barrier = this;
    return f;
  }
  Index passing(const StencilIncrement& increment, std::span<const Vec3> x,
                std::span<Vec3> stopped) const override;
  double entry(double t0, double t1, std::span<const Vec3> from, std::span<const Vec3> x) const override;

  // Whether the shape is where a pose says, and no free rigid body.
  bool follows_pose() const { return !points_; }
  // Whether the point of a stencil is on a rigid body and not a node.
  bool rides(Index s) const { return rider_[at(s)].has_value(); }
  // The pull of friction that a step left, in the axes of the shape [N].
  Vec3 kept_pull(Index s, std::span<const double> memory) const { return friction_memory().pull(s, memory); }
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
  double gap_rate(Index s, const ImpactStart& start, const ContactFrame& frame, const ContactFrame& later,
                  std::span<const Vec3> jump) const;
  struct Impact {
    std::array<Vec3, 8> velocity{};  // [m/s over N s]
    double mobility = 0;             // [1/kg]
  };
  Impact impact(Index s, const ImpactStart& start, const ContactFrame& frame) const;
  const Obstacle& obstacle() const { return shape_; }

 private:
  friend class FrictionalPool<ContactPool>;
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
  class Rates;  // contact_touch.cpp

  // What FrictionalPool asks.
  Frames frames(const StencilRequest& request) const;
  bool meets(Index) const { return true; }
  double open() const { return 0; }  // never asked: the shape is there for every point
  double stick(Index s) const { return stick_[at(s)]; }
  Gap gap_at(const Frames& frames, Index s, Want want) const;
  void add_curvature(const StencilRequest& request, const Frames& frames, const Gap& gap, Index s,
                     Mat3* blocks) const;
  TouchAt touch(const StencilRequest& request, const Frames& frames, Index s) const;
  Vec3 to_space(const Frames& frames, Index, const Vec3& own) const { return frames.lag.A * own; }
  Vec3 to_own(const Frames& frames, Index, const Vec3& v) const { return frames.now.inverse * v; }
  Rates rates(const StencilRequest& request, const Frames& frames, Index s, const TouchAt& touch) const;

  std::array<double, kMost> weights(Index s, const Vec3& own) const;
  bool meets_elsewhere(Index s, const Vec3& y0, const Vec3& y1, Vec3& met) const;

  Obstacle shape_;
  std::optional<ControlPoints> points_;
  std::vector<double> stick_, offset_;
  // Of nodes: the size of their cells, 0 of points on rigid bodies [m]; and as in add().
  std::vector<double> size_;
  std::vector<Vec3> inset_;
  // Of points on a free rigid body: which, and where; a node has none.
  std::vector<std::optional<ControlPoints>> rider_;
  std::vector<Vec3> rider_own_;
};

extern template class FrictionalPool<ContactPool>;  // contact_touch.cpp

}  // namespace isochor
