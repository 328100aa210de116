// Stencils of nodes against a rigid obstacle: the gap, and the potential of friction over an increment.
#pragma once

#include "constraints/obstacle_shape.h"
#include "engine/pool.h"

namespace isochor {

// One node a stencil and one function, its distance to the obstacle [m], negative inside. Its multiplier is
// minus the normal force.
//
// Friction is an energy. With the normal force N and the tangent plane held from the last iteration, the slip
// u since the increment began, measured on the obstacle, and the pull f0 that the last step left, it is
//   k/2 |z|^2 where k |z| <= mu N, else mu N |z| - (mu N)^2 / (2 k),   z = u + f0 / k,
// convex and once differentiable in x; its gradient is the friction force, k z or mu N z/|z|. The pull is
// kept between steps, so that what sticks does not creep.
class ContactPool final : public StencilPool {
 public:
  ContactPool(std::string name, Obstacle obstacle, double friction)
      : name_(std::move(name)), obstacle_(std::move(obstacle)), friction_(friction) {}
  // `stick`: stiffness of friction that sticks [N/m].
  void add(Index node, double stick);
  void finish() { finish_topology(); }

  std::string_view name() const override { return name_; }
  bool has_energy() const override { return friction_ > 0; }
  int functions() const override { return 1; }
  bool sees_rigid_motion() const override { return true; }
  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override;

  bool has_lag() const override { return friction_ > 0; }
  int memory() const override { return friction_ > 0 ? 3 * stencils() : 0; }
  void accept(const StencilRequest& request, std::span<double> memory) const override;
  bool has_barrier() const override { return obstacle_.shape != ObstacleShape::plane; }
  Index passing(const StencilIncrement& increment, std::span<const Vec3> x,
                std::span<Vec3> stopped) const override;

  const Obstacle& obstacle() const { return obstacle_; }

 private:
  struct Poses {
    ObstaclePose before, now;
  };
  struct Friction {
    double limit = 0;  // mu N [N]
    Vec3 normal{}, z{};
  };
  Poses poses(const StencilIncrement& increment) const {
    return {pose_of(obstacle_, increment.t0), pose_of(obstacle_, increment.t1)};
  }
  Friction friction(const StencilRequest& request, const Poses& poses, Index s) const;
  Vec3 pull(Index s, const Friction& f) const;

  std::string name_;
  Obstacle obstacle_;
  double friction_;
  std::vector<double> stick_;
};

}  // namespace isochor
