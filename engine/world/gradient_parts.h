// The parts of World::gradients(): the equilibrium with its factors, outputs as right-hand sides, and
// parameters as changes of the equations.
#pragma once

#include <map>

#include "engine/world/cell_terms.h"
#include "engine/world/equations.h"
#include "engine/world/lag_terms.h"
#include "isochor/gradients.h"

namespace isochor {

class CellStress;

// Whether the effect counts.
bool names_effect(const Output& output);
bool names_effect(const Parameter& parameter);

// How an output depends on the unknowns: dJ = x . dx + multiplier . dlambda + dseen + through . dR, where R
// are the forces of supports; and in motion + v . dv.
struct OutputSeed {
  OutputSeed() = default;
  OutputSeed(std::size_t nodes, std::size_t rows) : x(nodes), through(nodes), v(nodes), multiplier(rows, 0) {}
  void add(const OutputSeed& other);

  double value = 0;
  std::vector<Vec3> x, through, v;
  std::vector<double> multiplier;
  // What a parameter changes of it beside: indices into Equilibrium::watched.
  std::vector<Index> held;
  // What the stiffness of a cell changes of it beside: how many elastic energies it has, and stresses.
  double energies = 0;
  struct OfStress {
    Index body = -1, cell = -1;
    Stress weights{};
  };
  std::vector<OfStress> stresses;
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

  // gradient_measures.cpp
  // Notes what is to be watched for an output; before linearize(). The effect that it names is there.
  Result<void> watch(const Output& output);
  // gradient_outputs.cpp
  Result<OutputSeed> seed_of(const Output& output);
  // The solution of A z = (load, row) with given coordinates moved by `way`, in dx and dlambda.
  Result<void> solve(std::span<const Vec3> load, std::span<const double> row, std::span<const Vec3> way);
  Result<Adjoint> adjoint_of(const OutputSeed& seed);
  // Of A^T z = (load, row), for symmetric matrices as solve().
  Result<void> solve_transposed(std::span<const Vec3> load, std::span<const double> row);

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
  std::vector<Watched> watched;
  std::optional<LagTerms> lag;  // of an unsymmetric matrix
  std::vector<Vec3> dx;
  std::vector<double> dlambda;
  // Functions that make constants were held against the scene before, at another increment of the same way.
  bool compared = false;

 private:
  SaddleProblem problem() {
    SaddleProblem p = w.data->problem(w.system(), w.state, w.state.t);
    if (inertia) inertia->add_to(p);
    return p;
  }
  EquationsAt present() { return {w.system(), w.assembly(), *w.data, w.instances, w.said.builder, inertia}; }
  Result<void> check_balance();
  bool is_here(Equations off) const;
  Result<void> seed_gauge(const Output& output, OutputSeed& seed);
  Result<void> seed_reaction(const Output& output, OutputSeed& seed);
  Result<void> seed_positions(const Output& output, OutputSeed& seed);
  Result<void> seed_function(const Output& output, OutputSeed& seed);
  void forces_back(std::span<const Vec3> way, std::span<Vec3> x, std::span<double> row);
  // gradient_measures.cpp
  Index place_of(const Watched& one) const;
  Result<void> watch_stress(const Output& output);
  Result<void> watch_force(const Output& output);
  void take_watched(const Watched& one, OutputSeed& seed) const;
  void seed_energy(const Output& output, OutputSeed& seed);
  void seed_elastic(OutputSeed& seed);
  void seed_pressures(OutputSeed& seed);
  Result<void> seed_stress(const Output& output, OutputSeed& seed);
  void seed_force(const Output& output, OutputSeed& seed);
  void evaluate_here();
  void add_pool_forces(Index pool, std::span<const Vec3> along, OutputSeed& seed);
  void add_stress_of_rows(const CellStress& cell, RecoveryInput in, double weight,
                          std::span<double> multiplier) const;
  // What a factor on the stiffness of cells changes of stresses that are watched.
  void add_stress_of(std::span<const double> rate, BodyId body, Equations& change);
  // What the stiffness of each cell changes of the stresses that an output is of.
  struct StressShares {
    std::vector<std::pair<Index, double>> own;        // cells that have their own energy, and how much
    std::map<std::pair<Index, Index>, Stress> patch;  // by pool and stencil: of their stress
    double of(const CellTerms::Stencil& stencil, std::span<const Vec3> x) const;
  };
  StressShares stress_shares(const OutputSeed& seed, BodyId body);
  Result<void> respond(double factor, std::span<const Vec3> load, std::span<const double> row,
                       std::span<const Vec3> way, std::vector<Vec3>& x, std::vector<double>& lambda);
  Result<void> check_body(BodyId body, const char* who) const;
  Result<Equations> change_by_amount(const Parameter& parameter);
  Result<Equations> change_by_curve(const Parameter& parameter);
  void add_work(Watched::What energy, Equations& change) const;
  Result<Equations> change_by_stiffness(const Parameter& parameter);
  Result<Equations> change_by_density(const Parameter& parameter);
  Result<Equations> density_beside(const Parameter& parameter, std::span<const std::size_t> regions);
  void add_mass_change(const BodyData& body, std::span<const std::size_t> regions, Equations& change) const;
  Result<Equations> check_motion(const Parameter& parameter) const;
  Result<Equations> change_beside(const Parameter& parameter);
  Result<Description> beside(const Parameter& parameter, double at_value, bool& refused_by_law);
  Result<CellTerms> cell_terms(BodyId body) const;

  double force_scale_ = 1;
};

}  // namespace isochor
