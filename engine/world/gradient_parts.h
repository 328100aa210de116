// The parts of World::gradients(): the equilibrium with its factors, outputs as right-hand sides, and
// parameters as changes of the equations.
#pragma once

#include "engine/world/cell_terms.h"
#include "engine/world/equations.h"
#include "isochor/gradients.h"

namespace isochor {

// How an output depends on the unknowns: dJ = x . dx + multiplier . dlambda + dgauge + through . dR, where R
// are the forces of supports.
struct OutputSeed {
  double value = 0;
  std::vector<Vec3> x, through;
  std::vector<double> multiplier;
  bool energy = false;
  Index gauge = -1;  // what a parameter changes of it beside: index into Equilibrium::gauges
};

// What the solution of an output's own system says: a change dR of the equations changes the output by
// - force . dR - row . dtheta + given . (motion of given coordinates).
struct Adjoint {
  std::vector<Vec3> force, given;
  std::vector<double> row;
};

struct World::Impl::Equilibrium {
  // At the state of the world; with `inertia` at the end of an increment that a body moves in.
  explicit Equilibrium(Impl& world, const Inertia* inertia = nullptr);

  // Refuses what is no equilibrium, or has no derivative.
  Result<void> linearize(bool unstable);

  // gradient_outputs.cpp
  Result<OutputSeed> seed_of(const Output& output);
  // The solution of A z = (load, row) with given coordinates moved by `way`, in dx and dlambda.
  Result<void> solve(std::span<const Vec3> load, std::span<const double> row, std::span<const Vec3> way);
  Result<Adjoint> adjoint_of(const OutputSeed& seed);

  // gradient_parameters.cpp
  // dR/dp, all that is in Equations.
  Result<Equations> change_by(const Parameter& parameter);
  // What a change brings to an output, positions and multipliers held.
  static double held(const OutputSeed& seed, const Equations& change);
  double by_adjoint(const OutputSeed& seed, const Adjoint& adjoint, const Equations& change) const;
  double by_tangent(const OutputSeed& seed, const Equations& change) const;
  Result<std::vector<double>> by_cells(const OutputSeed& seed, const Adjoint& adjoint, BodyId body);
  // Where given coordinates go [m], of all nodes.
  std::vector<Vec3> way_of(std::span<const Vec3> position) const;

  Impl& w;
  const Inertia* inertia;
  SaddlePoint& method;
  SaddleReport report;
  Equations here;
  std::vector<GaugeName> gauges;
  std::vector<Vec3> dx;
  std::vector<double> dlambda;

 private:
  SaddleProblem problem() {
    SaddleProblem p = w.data->problem(w.system(), w.state, w.state.t);
    if (inertia) inertia->add_to(p);
    return p;
  }
  EquationsAt present() { return {w.system(), w.assembly(), *w.data, w.instances, inertia}; }
  Result<void> check_balance();
  Result<void> seed_gauge(const Output& output, OutputSeed& seed);
  Result<void> seed_reaction(const Output& output, OutputSeed& seed);
  void seed_energy(OutputSeed& seed);
  Result<void> respond(double factor, std::span<const Vec3> load, std::span<const double> row,
                       std::span<const Vec3> way, std::vector<Vec3>& x, std::vector<double>& lambda);
  Result<void> check_body(BodyId body, const char* who) const;
  Result<Equations> change_by_amount(const Parameter& parameter);
  Result<Equations> change_by_stiffness(const Parameter& parameter);
  Result<Equations> change_by_density(const Parameter& parameter);
  void add_mass_change(const BodyData& body, std::span<const std::size_t> regions, Equations& change) const;
  Result<Equations> check_motion(const Parameter& parameter) const;
  Result<Equations> change_beside(const Parameter& parameter);
  Result<Description> beside(const Parameter& parameter, double at_value, bool& refused_by_law);
  Result<CellTerms> cell_terms(BodyId body) const;

  double force_scale_ = 1;
};

}  // namespace isochor
