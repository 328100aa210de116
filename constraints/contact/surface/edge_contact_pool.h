// Stencils of edges on moving surfaces against edges that they cross.
#pragma once

#include "constraints/contact/friction/friction_spring.h"
#include "constraints/contact/surface/skin_edges.h"
#include "engine/system/pool.h"

namespace isochor {

// One stencil an edge that bulges outward and one function, the value of EdgeGap to the edge of the other
// side that it meets: its partner. The nodes are those of EdgeGap; edges without a partner have none, and a
// gap that is never closed. Both edges of a pair have a stencil, so that neither is master or slave. Friction
// as in SurfaceContactPool, the pull of the last step turning with the edge.
class EdgeContactPool final : public StencilPool {
 public:
  // What pools that replace each other share.
  struct Setup {
    std::string name;
    std::shared_ptr<const SkinEdges> edges;
    double offset = 0;  // [m]
    FrictionLaw friction;
    bool coupled = false;
    std::vector<double> stick;  // by edge: stiffness of friction that sticks [N/m]
    double open = 1;            // gap of edges without a partner [m]
  };
  EdgeContactPool(std::shared_ptr<const Setup> setup, std::vector<Index> partner);

  std::string_view name() const override { return setup_->name; }
  bool has_energy() const override { return setup_->friction.any(); }
  int functions() const override { return 1; }
  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override;

  bool has_lag() const override { return setup_->friction.any(); }
  bool couples() const override { return setup_->friction.any() && setup_->coupled; }
  void lag_derivatives(const StencilRequest& request, const LagSlots& slots) const override;
  // By edge: one more than the partner, then the pull in the axes of the edge and what the law keeps.
  int memory() const override { return memory_per_edge() * stencils(); }
  void accept(const StencilRequest& request, std::span<double> memory) const override;
  bool follows() const override { return true; }
  FollowAnswer followed(const FollowRequest& request) const override;
  Result<std::shared_ptr<const StencilPool>> restored(std::span<const double> memory) const override;

  const Setup& setup() const { return *setup_; }
  bool has_partner(Index s) const { return partner_[at(s)] >= 0; }
  // Of edges that have a partner.
  EdgeGap gap(Index s, std::span<const Vec3> x) const { return edge_gap(places(s, x), setup_->offset); }
  // What the first edge feels of a multiplier [N].
  Vec3 push(Index s, double multiplier, std::span<const Vec3> x) const;
  // The pull of friction that a step left, at positions x [N].
  Vec3 kept_pull(Index s, std::span<const double> memory, std::span<const Vec3> x) const;

 private:
  struct Friction {
    FrictionSpring spring;
    EdgeGap gap;
    double mu = 0;
    Vec3 whole{};  // slip, with what the last step left of the pull, not yet across the normal [m]
  };
  double coefficient(Index s, std::span<const double> memory) const;
  int memory_per_edge() const { return setup_->friction.any() ? 4 + setup_->friction.memory() : 1; }
  std::array<Vec3, kPairNodes> places(Index s, std::span<const Vec3> x) const;
  Friction friction(const StencilRequest& request, Index s) const;
  Mat3 axes(Index s, std::span<const Vec3> x) const;
  // Of kept_pull() when node `node` of the stencil moves.
  Vec3 kept_pull_rate(Index s, std::span<const double> memory, std::span<const Vec3> x, std::size_t node,
                      const Vec3& rate) const;
  double reach() const { return setup_->offset + 0.75 * setup_->edges->size(); }

  std::shared_ptr<const Setup> setup_;
  std::vector<Index> partner_;
};

}  // namespace isochor
