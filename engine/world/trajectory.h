// Gradients of what is seen on a way through time.
//
// Every increment solves R(z; y, p) = 0 for z = (x, lambda) where it is evaluated, from what came before,
// y = (positions, velocities, what the scheme keeps), and goes on to y' = A y + B x: time schemes are linear
// maps of each node (integrators/), with coefficients that follow from the scheme itself (StepMap). Inertia
// in R is s M (x - P y). So, for an output J:
//
//   adjoint   backward: with y_bar' = dJ/dy' of what comes after and of outputs there, solve
//             A(z) a = (B^T y_bar', dJ/dlambda); then dJ/dp -= a . dR/dp and
//             y_bar = A^T y_bar' + P^T (s M a)
//   tangent   forward: solve A(z) dz = -dR/dp + s M P dy; then dy' = A dy + B dx
//
// Damping depends on where the increment began as well; its potential is the same when both ends change
// places, so that what it adds to either way follows from its forces (DissipativeStencils).
//
// Outputs of an increment itself (reactions, gauges, stresses, ...) are looked at where it was evaluated. A
// reaction is a force of R, which depends on y as R does.
//
// Each increment is linearized where it was solved, by its own matrix, as World::gradients() does (the
// outline stands there). Forward that is done on the way. Backward, states of the way are kept, or made again
// from those that are (revolve.h).
#pragma once

#include <functional>
#include <optional>

#include "engine/world/gradient_parts.h"
#include "engine/world/memory_terms.h"
#include "engine/world/step_map.h"

namespace isochor {

// What an increment begins with, or how an output depends on it: positions, velocities and the lists that the
// scheme keeps, one vector a node each.
using Lists3 = std::vector<std::vector<Vec3>>;

class World::Impl::Trajectory {
 public:
  Trajectory(World& world, const TrajectoryQuery& query) : world_(world), w_(*world.impl_), query_(query) {}

  Result<void> check();
  Result<Gradients> gradients();
  // To the end of the way, or back to where it began. Takes no memory.
  void leave(bool at_end) noexcept;

 private:
  // All that steps change.
  struct Moment {
    State state;
    std::vector<double> amounts;
  };
  // An increment that was made, looked at where it was evaluated.
  struct Increment {
    StepMap map;
    Inertia inertia;
  };
  // The same with its factors; what outputs have at its end, and how parameters change its equations.
  struct Linearized {
    Index step;
    const Increment& increment;
    Equilibrium& eq;
    std::span<OutputSeed> seeds;
    std::span<const Equations> change;
    const MemoryTerms& memory;
  };
  // Of the beginning of an increment, how it is felt or moves: lists of nodes, and numbers of memory.
  struct Carried {
    Lists3 lists;
    std::vector<double> memory;
  };
  std::vector<Carried> nothing(std::size_t count) const;
  Index steps() const { return static_cast<Index>(query_.steps.size()); }
  bool dissipates() const { return !w_.system().facets().dissipative.empty(); }
  bool ends_there() const { return w_.options.scheme->evaluated_at() == 1; }
  bool by_adjoint() const;
  Result<void> check_parameters() const;
  Result<void> check_outputs() const;
  Result<void> check_pools();
  std::vector<Vec3> gradient_of(Index pool, const StencilIncrement& increment, std::span<const Vec3> x) const;
  std::vector<Vec3> dissipation(StencilIncrement increment, std::span<const Vec3> x,
                                std::span<const Vec3> before) const;
  // How forces of dissipation change along a direction of the beginning of an increment, and the transpose.
  std::vector<Vec3> dissipation_along(const Increment& increment, std::span<const Vec3> way) const;
  std::vector<Vec3> dissipation_back(const Increment& increment, std::span<const Vec3> way) const;
  Moment now() const;
  void restore(Moment moment) noexcept;
  Result<void> make_step(Index n);
  void stand_at(const State& state, const State& memory_of);
  Increment stand_in(Index n);
  Result<void> watch(Equilibrium& eq, Index n) const;
  Result<std::vector<OutputSeed>> seeds_of(Equilibrium& eq, Index n, Gradients& out) const;
  // Linearizes increment n and hands it on.
  template <class Visit>
  Result<void> in_increment(Index n, Gradients& out, Visit&& visit);
  Result<void> go_back(Gradients& out);
  Result<void> go_along(Gradients& out);
  void add_start(std::span<const OutputSeed> seeds, std::vector<Carried>& felt, Gradients& out) const;
  Result<void> step_back(const Linearized& here, std::vector<Carried>& felt, Gradients& out) const;
  Result<void> step_along(const Linearized& here, std::vector<Carried>& moved, Gradients& out) const;
  // What an increment adds to the gradients by the adjoint of output j.
  Result<void> gather(const Linearized& here, std::size_t j, const Adjoint& adjoint, Gradients& out) const;
  Result<std::vector<Equations>> changes(Equilibrium& eq) const;
  std::vector<Vec3> in_scene(const Parameter& p) const;
  std::vector<Vec3> heavy(double factor, std::span<const Vec3> v) const;
  // Rows that are about to touch or to let go, where an increment was evaluated.
  void look_for_edges(Index n, Gradients& out) const;
  // Visits increments: on the way, or when it is gone from the last to the first.
  using OfStep = std::function<Result<void>(Index)>;
  Result<void> each_forward(const OfStep& visit);
  Result<void> each_backward(const OfStep& visit);
  Index most_kept() const;
  Result<void> go();
  void keep(Index step);
  Result<void> find_before(Index step);

  World& world_;
  Impl& w_;
  const TrajectoryQuery& query_;
  std::optional<Moment> start_, end_;
  std::optional<Moment> before_, after_;        // where the increment at hand begins and ends
  std::vector<std::pair<Index, Moment>> kept_;  // by step, ascending; beside start_
  Index most_at_once_ = 0, steps_made_ = 0;
  std::size_t lists_ = 2;
  bool compared_ = false;  // parameters with the scene, at an increment
};

// What the query is refused with; and, as its own, what World::gradients() says about a step or an entry of a
// list.
Error trajectory_error(const std::string& text);
Error in_step(Index n, const Error& error);
Error in_list(const char* list, std::size_t k, const Error& error);

}  // namespace isochor
