// Extended position-based dynamics (Macklin, Mueller & Chentanez 2016) on the stencils and rows of a system:
// the cheap end of the scale, and another model. A fixed number of Gauss-Seidel sweeps visits every energy,
// as the compliant constraint sqrt(2 energy) = 0 of compliance 1, and every row with its compliance and its
// bounds. Gradients are those of the moment of a visit, so what a step ends at is not the solution of the
// implicit step, and how far off it is depends on sweeps, step and mesh. With one sweep and short steps it is
// the small-step variant (Macklin et al. 2019).
#pragma once

#include "engine/solve/saddle_point.h"

namespace isochor {

class PositionBased : public SaddlePoint {
 public:
  PositionBased(std::shared_ptr<const System> system, const Parallel& parallel,
                std::unique_ptr<LinearSolver> solver, int sweeps);

  // Empty, or what in a system this method has no answer for.
  static std::string unsupported(const System& system);

  int colors() const { return static_cast<int>(color_start_.size()) - 1; }

 protected:
  // Needs inertia. `converged` means that the sweeps are done and all is finite; the residuals tell the rest.
  SaddleReport solve_from_here(const SaddleProblem& problem, const SaddleOptions& options) override;

 private:
  // An energy of a stencil, or a row.
  struct Constraint {
    Index pool = -1;  // -1: a row
    Index item = 0;   // stencil of the pool, or row
  };
  void color();
  void start(const SaddleProblem& p, std::span<Vec3> x, std::span<const double> lambda);
  void visit(const Constraint& c, std::span<Vec3> x, std::span<double> lambda,
             std::span<const double> target);
  void visit_energy(const Constraint& c, std::span<Vec3> x);
  void visit_row(Index row, std::span<Vec3> x, std::span<double> lambda, std::span<const double> target);
  void evaluate_stencil(Index pool, Index stencil, std::span<const Vec3> x);
  Vec3 mobile(Index node, const Vec3& v) const;

  const Parallel& parallel_;
  int sweeps_;
  // Constraints of a color share no node and no compliance, so that they are visited in any order; those
  // from color_start_.back() on are visited one after the other.
  std::vector<Constraint> constraints_;
  std::vector<std::size_t> color_start_;
  std::vector<double> inverse_mass_;     // over the mass scale: displacement a force [m/N]
  std::vector<double> energy_strength_;  // multiplier of each energy
  // Stencils of a row, each once, and its compliance: entries that name it, both ways.
  Lists row_stencils_;
  std::vector<Index> row_pool_;
  Lists row_compliance_;  // places in compliance()
  std::vector<double> compliance_;
  // Slots of stencils, as in Assembly.
  std::vector<double> energy_, value_, zero_;
  std::vector<Vec3> gradient_, jacobian_, force_;
};

}  // namespace isochor
